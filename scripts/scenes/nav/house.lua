-- Two rooms, a wide door that opens and shuts, a narrow gap that is always open, steps to a gallery:
-- agents walk between random places. With the door the surface changes, and all plan anew.
local n = corsac.param("n", 12)
local nav, scene, gfx = corsac.nav, corsac.scene, corsac.gfx

local level = {
    { position = { 0, -0.5, 0 }, size = { 24, 1, 16 } },
    { position = { 0, 1.25, -5 }, size = { 0.3, 2.5, 6 } }, -- walls beside the door
    { position = { 0, 1.25, 5 }, size = { 0.3, 2.5, 2 } },
    { position = { 0, 1.25, 7.9 }, size = { 0.3, 2.5, 0.2 } },
    { position = { -6, 0.6, 2 }, size = { 3, 1.2, 1.5 } }, -- a table one cannot climb
    { position = { 9.5, 1.0, -5 }, size = { 5, 2.0, 6 } }, -- the gallery
}
for i = 1, 6 do
    level[#level + 1] = { position = { 3.3 + 0.6 * i, 2 * i / 14, -5 }, size = { 0.6, 4 * i / 14, 2.4 } }
end
local door = { position = { 0, 1.25, 1 }, size = { 0.3, 2.5, 6 } }
local surfaces, doorEntity, agents, shut, walks = {}, nil, {}, false, 0

local function withDoor()
    local all = { door }
    for _, box in ipairs(level) do all[#all + 1] = box end
    return all
end

local function send(agent)
    local x, z = 22 * math.random() - 11, 14 * math.random() - 7
    local y = x > 7 and z < -2 and 2 or 0
    local px, py, pz = surfaces[shut]:nearest(x, y, z)
    agent:cross(surfaces[shut], px, py, pz)
end

function corsac.load()
    surfaces[false] = nav.newSurface{ boxes = level, cellSize = 0.2 }
    surfaces[true] = nav.newSurface{ boxes = withDoor(), cellSize = 0.2 }
    for _, box in ipairs(level) do
        scene.spawn{ position = box.position, scale = box.size, mesh = "box", color = { 0.55, 0.5, 0.44 } }
    end
    doorEntity = scene.spawn{ position = { 0, -4, 1 }, scale = door.size, mesh = "box", color = { 0.5, 0.25, 0.1 } }
    for i = 1, n do
        local body = scene.spawn{
            position = { i <= n / 2 and -10 or 10, 0.9, 1.1 * (i % 6) }, scale = { 0.6, 0.9, 0.6 },
            mesh = "capsule", color = { 0.9, 0.5 + 0.4 * i / n, 0.2 },
        }
        agents[i] = nav.newAgent{ entity = body, offset = 0.9, turnRate = 8 }
        send(agents[i])
    end
    gfx.setCamera{ position = { 0, 18, 16 }, target = { 0, 0, 0 } }
end

function corsac.fixed()
    local step = corsac.getStep()
    if step % 600 == 300 then
        shut = not shut
        doorEntity:setPosition(0, shut and 1.25 or -4, 1)
        for _, agent in ipairs(agents) do send(agent) end
    end
    for _, agent in ipairs(agents) do
        local state = agent:getState()
        if state == "arrived" then
            walks = walks + 1
            send(agent)
        elseif state == "stuck" and step % 120 == 0 then
            send(agent) -- wedged in the gap: somewhere else, then
        end
    end
    corsac.metrics.set("walks", walks)
end

function corsac.conf(t) t.steps = 3600 end
corsac.expect("user.walks", ">=", 4 * n)
corsac.expect("accuracy.nan", "==", 0)
