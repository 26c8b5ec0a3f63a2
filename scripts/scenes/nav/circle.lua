-- Agents on a circle all cross to the other side, each in the way of all others: n agents, radius
-- of the circle so that they have room to stand. Nobody may touch anybody, and all must arrive.
local n = corsac.param("n", 120)
local nav, scene, gfx = corsac.nav, corsac.scene, corsac.gfx

local radius = math.max(6, n * 1.1 / (2 * math.pi))
local agents, worst = {}, 0

function corsac.conf(t)
    t.steps = math.floor((2 * radius / 1.5 * 3 + 20) * 60)
end

function corsac.load()
    local side = 2 * radius + 6
    local ground = { position = { 0, -0.5, 0 }, size = { side, 1, side } }
    local surface = nav.newSurface{ boxes = { ground } }
    scene.spawn{ position = ground.position, scale = ground.size, mesh = "box", color = { 0.35, 0.4, 0.34 } }
    for i = 1, n do
        local angle = 2 * math.pi * i / n
        local x, z = radius * math.cos(angle), radius * math.sin(angle)
        local hue = i / n
        local body = scene.spawn{
            position = { x, 0.9, z }, scale = { 0.6, 0.9, 0.6 }, mesh = "capsule",
            color = { 0.5 + 0.5 * math.cos(6.28 * hue), 0.5 + 0.5 * math.cos(6.28 * (hue - 0.33)),
                0.5 + 0.5 * math.cos(6.28 * (hue - 0.67)) },
        }
        agents[i] = nav.newAgent{ entity = body, offset = 0.9 }
        agents[i]:cross(surface, -x, 0, -z)
    end
    gfx.setCamera{ position = { 0, 1.5 * radius, 1.3 * radius }, target = { 0, 0, 0 } }
end

-- garbage: two bytes an agent and step, boxed where a step leaves compiled code
local x, z = {}, {}

function corsac.fixed()
    local arrived = 0
    for i, agent in ipairs(agents) do
        local _
        x[i], _, z[i] = agent:getPosition()
        arrived = arrived + (agent:getState() == "arrived" and 1 or 0)
        for k = 1, i - 1 do
            local dx, dz = x[i] - x[k], z[i] - z[k]
            local square = dx * dx + dz * dz
            if square < 0.36 then worst = math.max(worst, 0.6 - math.sqrt(square)) end
        end
    end
    corsac.metrics.set("arrived", arrived)
    corsac.metrics.set("overlap", worst)
end

corsac.expect("user.arrived", "==", n)
corsac.expect("user.overlap", "<=", 0.006) -- 2 % of the radius
