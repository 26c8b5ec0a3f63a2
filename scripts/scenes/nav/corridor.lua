-- Two crowds meet in a corridor: n agents in all, each goes to the mirrored place on the other side.
-- With gap = 1 it holds one at a time, and they take turns.
local n = corsac.param("n", 200)
local gap = corsac.param("gap", 2.4)
local nav, scene, gfx = corsac.nav, corsac.scene, corsac.gfx
local show = corsac.param("show", false)
local surface, agents, worst, last = nil, {}, 0, 0
local px, pz = {}, {}

function corsac.conf(t) t.steps = 60 * (100 + n * (gap < 1.8 and 12 or 1)) end

function corsac.load()
    local level = {
        { position = { 0, -0.5, 0 }, size = { 60, 1, 12 } },
        { position = { 0, 1, -3 - gap / 4 }, size = { 12, 2, 6 - gap / 2 } },
        { position = { 0, 1, 3 + gap / 4 }, size = { 12, 2, 6 - gap / 2 } },
    }
    surface = nav.newSurface{ boxes = level, cellSize = math.min(0.2, gap / 16) }
    for _, b in ipairs(level) do
        scene.spawn{ position = b.position, scale = b.size, mesh = "box", color = { 0.5, 0.48, 0.44 } }
    end
    for i = 1, n do
        local row, side = math.floor((i - 1) / 20), i % 2 == 0 and 1 or -1
        local x, z = side * (19.5 + 0.9 * row), math.floor((i - 1) % 20 / 2) - 4.5
        local body = scene.spawn{
            position = { x, 0.9, z }, scale = { 0.6, 0.9, 0.6 }, mesh = "capsule",
            color = side > 0 and { 0.9, 0.4, 0.2 } or { 0.2, 0.5, 0.9 },
        }
        agents[i] = nav.newAgent{ entity = body, offset = 0.9 }
        agents[i]:cross(surface, side * (0.9 * row - 28.5), 0, z)
    end
    gfx.setCamera{ position = { 0, 26, 18 }, target = { 0, 0, 0 } }
end

function corsac.fixed(dt)
    local arrived = 0
    for i, agent in ipairs(agents) do
        local _
        px[i], _, pz[i] = agent:getPosition()
        arrived = arrived + (agent:getState() == "arrived" and 1 or 0)
    end
    if corsac.getStep() % 6 == 0 then
        for i = 1, n do
            for k = 1, i - 1 do
                local dx, dz = px[i] - px[k], pz[i] - pz[k]
                local square = dx * dx + dz * dz
                if square < 0.36 then worst = math.max(worst, 0.6 - math.sqrt(square)) end
            end
        end
    end
    if arrived < n then last = corsac.getStep() * dt end
    corsac.metrics.set("arrived", arrived)
    corsac.metrics.set("overlap", worst)
    corsac.metrics.set("seconds", last)
end

function corsac.draw()
    if show then
        surface:draw()
        nav.drawAgents()
    end
end

corsac.expect("user.arrived", "==", n)
corsac.expect("user.overlap", "<=", 0.006) -- 2 % of the radius
