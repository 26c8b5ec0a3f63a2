-- Stairs, ramps, a bridge over a passage and a ladder: movers led by agents go where the surface
-- says they can, up and down; nobody falls.
local nav, scene, gfx, phys = corsac.nav, corsac.scene, corsac.gfx, corsac.phys
local show = corsac.param("show", false)
local surface, walkers, lowest, trips = nil, {}, 0, 0
local goals = { { -10, 0, 6 }, { 8, 2.4, 6 }, { 8, 2.4, -6 }, { -10, 0, -6 }, { 0, 0, 0 }, { 0, 2.4, 6 } }

local function box(x, y, z, wide, high, deep, turn)
    scene.spawn{
        position = { x, y, z }, rotation = turn, mesh = "box", color = { 0.5, 0.48, 0.44 },
        body = { type = "static", shape = "box", size = { wide, high, deep } },
    }
end

local function send(walker)
    walker.goal = walker.goal % #goals + 1
    local g = goals[walker.goal]
    walker.agent:cross(surface, g[1], g[2], g[3])
end

function corsac.conf(t) t.steps = 60 * 90 end

function corsac.load()
    box(0, -0.5, 0, 30, 1, 20)
    for i = 1, 12 do -- steps of 20 cm
        box(-3 + 0.4 * i - 1.6, 0.1 * i, 6, 0.4, 0.2 * i, 3)
    end
    box(6.7, 2.3, 6, 8.2, 0.2, 3) -- a bridge, free below
    box(1.6, 2.3, 6, 2.4, 0.2, 3)
    box(8, 2.3, 0, 3, 0.2, 9.4)
    box(8, 2.3, -6, 5, 0.2, 3)
    local slope = math.atan(2.4 / 6)
    box(2.52, 1.105, -6, 6.5, 0.2, 3, { axis = { 0, 0, 1 }, angle = slope }) -- a ramp
    surface = nav.newSurface{ from = "physics", cellSize = 0.15, climb = 0.25, slope = 0.8 }
    for i = 1, 4 do
        local mover = phys.newMover{ position = { -10, 0.9, 2.2 * i - 5.5 }, stepHeight = 0.25 }
        walkers[i] = { mover = mover, goal = i, agent = nav.newAgent{ mover = mover, offset = 0.9, arrive = 0.4 } }
        walkers[i].body = scene.spawn{
            position = { 0, -9, 0 }, scale = { 0.6, 0.9, 0.6 }, mesh = "capsule", color = { 0.9, 0.2 * i, 0.2 },
        }
        send(walkers[i])
    end
    gfx.setCamera{ position = { 0, 15, 20 }, target = { 0, 0, 0 } }
end

function corsac.fixed()
    local stuck = 0
    for _, walker in ipairs(walkers) do
        local x, y, z = walker.mover:getPosition()
        walker.body:setPosition(x, y, z)
        lowest = math.min(lowest, y - 0.9)
        local state = walker.agent:getState()
        if state == "arrived" then
            trips = trips + 1
            send(walker)
        elseif state == "stuck" then
            stuck = stuck + 1
        end
    end
    corsac.metrics.set("trips", trips)
    corsac.metrics.set("lowest", lowest)
    corsac.metrics.set("stuck", stuck)
end

function corsac.draw()
    if show then
        surface:draw()
        nav.drawAgents()
    end
end

corsac.expect("user.trips", ">=", 16)
corsac.expect("user.lowest", ">=", -0.05)
corsac.expect("user.stuck", "==", 0)
