-- Rooms in a row with doors that open to whoever comes near (triggers) and shut behind them. A shut
-- door is part of the surface, a link of kind "door" leads through it.
local n = corsac.param("n", 6)
local nav, scene, gfx, phys = corsac.nav, corsac.scene, corsac.gfx, corsac.phys
local show = corsac.param("show", false)
local surface, agents, doors, passed, trips = nil, {}, {}, 0, 0

local function box(x, y, z, wide, high, deep, kind)
    return scene.spawn{
        position = { x, y, z }, mesh = "box", color = kind and { 0.5, 0.25, 0.1 } or { 0.5, 0.48, 0.44 },
        body = { type = kind or "static", shape = "box", size = { wide, high, deep } },
    }
end

local function send(agent, i)
    agent:cross(surface, agent.left and -13 or 13, 0, 2.4 * ((i - 1) % 5) - 4.8)
    agent.left = not agent.left
end

function corsac.conf(t) t.steps = 60 * 60 end

function corsac.load()
    box(0, -0.5, 0, 32, 1, 14)
    for i, x in ipairs{ -6, 0, 6 } do
        box(x, 1.25, -4, 0.3, 2.5, 6)
        box(x, 1.25, 4, 0.3, 2.5, 6)
        doors[i] = { body = box(x, 1.25, 0, 0.2, 2.5, 2, "kinematic"), x = x, near = 0, open = 0 }
        local door = doors[i]
        phys.newTrigger{
            shape = "box", size = { 4, 3, 4 }, position = { x, 1.5, 0 },
            onEnter = function() door.near = door.near + 1 end,
            onExit = function() door.near = door.near - 1 end,
        }
    end
    surface = nav.newSurface{ from = "physics", kinematic = true, cellSize = 0.15, climb = 0.2 }
    for _, door in ipairs(doors) do
        door.link = surface:addLink{
            from = { door.x - 1.2, 0, 0 }, to = { door.x + 1.2, 0, 0 }, bothWays = true, kind = "door",
        }
    end
    for i = 1, n do
        local body = scene.spawn{
            position = { i % 2 == 0 and -13 or 13, 0.9, 2.2 * math.floor((i - 1) / 2) - 4 }, mesh = "capsule",
            color = { 0.9, i / n, 0.3 },
            body = { shape = "capsule", radius = 0.3, height = 1.8, locks = "turnX turnY turnZ" },
        }
        agents[i] = { left = i % 2 == 1, agent = nav.newAgent{ entity = body, offset = 0.9, arrive = 0.5 } }
        agents[i].cross = function(self, ...) self.agent:cross(...) end
        send(agents[i], i)
    end
    gfx.setCamera{ position = { 0, 18, 16 }, target = { 0, 0, 0 } }
end

function corsac.fixed(dt)
    for _, door in ipairs(doors) do
        local wanted = door.near > 0 and 2.1 or 0
        local before = door.open
        door.open = math.max(math.min(wanted, before + 3 * dt), before - 3 * dt)
        door.body:setPosition(door.x, 1.25, door.open)
    end
    for i, one in ipairs(agents) do
        if one.agent:getState() == "arrived" then
            trips = trips + 1
            send(one, i)
        end
        if one.agent:getLink() then passed = passed + 1 end
    end
    corsac.metrics.set("trips", trips)
    corsac.metrics.set("stepsOnLinks", passed)
end

function corsac.draw()
    if show then
        surface:draw()
        nav.drawAgents()
    end
end

corsac.expect("user.trips", ">=", n)
corsac.expect("user.stepsOnLinks", ">=", 100)
corsac.expect("accuracy.nan", "==", 0)
