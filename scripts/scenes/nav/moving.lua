-- Balls roll and a cart shuttles across a yard; agents with one goal (a flow) walk through without
-- being hit. A wall is built and torn down on the way: the surface follows.
local n = corsac.param("n", 16)
local nav, scene, gfx, phys = corsac.nav, corsac.scene, corsac.gfx, corsac.phys
local show = corsac.param("show", false)
local surface, flow, agents, balls, cart, wall, nearest = nil, nil, {}, {}, nil, nil, 99

local function send(i)
    local z = 1.5 * ((i - 1) % 8) - 5
    agents[i]:cross(surface, agents[i]:getPosition() > 0 and -13 or 13, 0, z)
end

function corsac.conf(t) t.steps = 60 * 75 end

function corsac.load()
    phys.setGravity(0, -9.81, 0)
    scene.spawn{
        position = { 0, -0.5, 0 }, mesh = "box", color = { 0.3, 0.34, 0.3 },
        body = { type = "static", shape = "box", size = { 32, 1, 16 } },
    }
    cart = scene.spawn{
        position = { 0, 0.5, 0 }, mesh = "box", color = { 0.5, 0.3, 0.2 },
        body = { type = "kinematic", shape = "box", size = { 1.4, 1, 1.4 } },
    }
    for i = 1, 4 do
        balls[i] = scene.spawn{
            position = { 3 * i - 7.5, 0.5, 7 * (i % 2 == 0 and 1 or -1) }, mesh = "sphere", color = { 0.8, 0.7, 0.2 },
            body = { shape = "sphere", radius = 0.5, velocity = { 0, 0, i % 2 == 0 and -1.5 or 1.5 } },
        }
    end
    surface = nav.newSurface{ from = "physics", cellSize = 0.25 }
    flow = nav.newFlow(surface, { 13, 0, 0 })
    for i = 1, n do
        local body = scene.spawn{
            position = { -13 + 0.9 * math.floor((i - 1) / 8), 0.9, 1.5 * ((i - 1) % 8) - 5 },
            scale = { 0.6, 0.9, 0.6 }, mesh = "capsule", color = { 0.2, 0.4 + 0.5 * i / n, 0.9 },
        }
        agents[i] = nav.newAgent{ entity = body, offset = 0.9, arrive = 2.5 }
        agents[i]:follow(flow)
    end
    gfx.setCamera{ position = { 0, 18, 16 }, target = { 0, 0, 0 } }
end

function corsac.fixed()
    local step, arrived = corsac.getStep(), 0
    if step == 240 then
        wall = scene.spawn{
            position = { 8, 1, 2 }, mesh = "box", color = { 0.5, 0.48, 0.44 },
            body = { type = "static", shape = "box", size = { 0.5, 2, 8 } },
        }
    elseif step == 2100 then
        wall:destroy()
        for i = 1, n do send(i) end
    end
    cart:getBody():setVelocity(0, 0, step % 600 < 300 and 1.0 or -1.0)
    for _, ball in ipairs(balls) do
        local _, _, z = ball:getPosition()
        if math.abs(z) > 7 then
            ball:getBody():setVelocity(0, 0, z > 0 and -1.5 or 1.5)
        end
    end
    for _, agent in ipairs(agents) do
        arrived = arrived + (agent:getState() == "arrived" and 1 or 0)
        local x, _, z = agent:getPosition()
        for _, ball in ipairs(balls) do
            local bx, _, bz = ball:getPosition()
            nearest = math.min(nearest, math.sqrt((x - bx) ^ 2 + (z - bz) ^ 2))
        end
    end
    corsac.metrics.set("arrived", arrived)
    corsac.metrics.set("nearest", nearest)
    if step == 2090 then corsac.metrics.set("first", arrived) end
end

function corsac.draw()
    if show then
        surface:draw()
        nav.drawAgents()
    end
end

corsac.expect("user.first", "==", n)
corsac.expect("user.arrived", "==", n)
corsac.expect("user.nearest", ">=", 0.75) -- ball and agent have 0.8 m between their middles
