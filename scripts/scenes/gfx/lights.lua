-- The report's test of its clustered renderer: many small lights over a hall of boxes.
-- n: how many lights; method: forward, clustered or auto; move: whether they wander.
local n = corsac.param("n", 1024)
local method = corsac.param("method", "auto")
local move = corsac.param("move", true)

local gfx, scene = corsac.gfx, corsac.scene
local lights = {}

function corsac.conf(t)
    t.steps = 60
    t.size = { 960, 540 }
end

local function addBox(position, scale, color)
    scene.spawn{ mesh = "box", position = position, scale = scale, color = color }
end

local function addHall()
    addBox({ 0, -0.5, 0 }, { 100, 1, 100 }, { 0.6, 0.6, 0.62 })
    for _, side in ipairs{ -1, 1 } do
        addBox({ side * 50.5, 5, 0 }, { 1, 12, 102 }, { 0.7, 0.65, 0.6 })
        addBox({ 0, 5, side * 50.5 }, { 100, 12, 1 }, { 0.6, 0.65, 0.7 })
    end
    for _ = 1, 400 do
        local side = 0.5 + 2 * math.random()
        local x, z = math.random() * 98 - 49, math.random() * 98 - 49
        addBox({ x, side, z }, { side, 2 * side, side }, { 0.8, 0.8, 0.8 })
    end
end

function corsac.load()
    gfx.setRender(method)
    gfx.setAmbient(0.01, 0.012, 0.016)
    gfx.setBackground(0.004, 0.005, 0.008)
    addHall()
    for i = 1, n do
        local x, y, z = math.random() * 98 - 49, 0.4 + math.random() * 5, math.random() * 98 - 49
        local hue = 6 * math.random()
        local function channel(shift) return math.max(0.1, math.min(1, math.abs((hue + shift) % 6 - 3) - 1)) end
        local light = gfx.newLight{
            position = { x, y, z }, radius = 5, intensity = 3, color = { channel(0), channel(4), channel(2) },
        }
        lights[i] = { light = light, x = x, y = y, z = z, phase = 6.28 * math.random() }
    end
    gfx.setCamera{ position = { 0, 9, 49 }, target = { 0, 0, 10 }, far = 120 }
end

local time = 0
function corsac.update(dt)
    time = time + dt
    if not move then return end
    for _, l in ipairs(lights) do
        l.light:setPosition(l.x + math.sin(time + l.phase), l.y, l.z + math.cos(time + l.phase))
    end
end
