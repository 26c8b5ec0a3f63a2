-- Thousands of spheres of radius 0.5 m fall into a box: scene S1 of the engine comparison.
-- n: how many; walls: whether the box has walls.
local n = corsac.param("n", 2500)
local walls = corsac.param("walls", true)

local scene, phys, gfx = corsac.scene, corsac.phys, corsac.gfx

-- The scene's own generator, so that other engines can lay out the same spheres: a 64-bit linear
-- congruential sequence, of which the upper 24 bits are used.
local state

local function symmetric(a)
    state = state * 6364136223846793005ULL + 1442695040888963407ULL
    local value = tonumber(bit.rshift(state, 40)) / 2 ^ 24
    return (2 * value - 1) * a
end

local function addBox(position, size, color)
    scene.spawn{
        position = position, mesh = color and "box" or nil, color = color,
        body = { type = "static", shape = "box", size = size },
    }
end

local function addShown(position, size)
    scene.spawn{ position = position, scale = size, mesh = "box", color = { 0.3, 0.33, 0.4 } }
end

-- Floor with its top at y = 0 and four walls, 40 m high, whose inner faces are h away. Walls take
-- part in the simulation only; what is drawn of them is low enough to look inside.
local function addBin(h, shown)
    addBox({ 0, -1, 0 }, { 2 * h + 4, 2, 2 * h + 4 }, { 0.42, 0.45, 0.52 })
    if not walls then return end
    for _, side in ipairs{ 1, -1 } do
        addBox({ side * (h + 0.5), 20, 0 }, { 1, 40, 2 * h + 2 })
        addBox({ 0, 20, side * (h + 0.5) }, { 2 * h + 2, 40, 1 })
        local height = side < 0 and shown or 0.6
        addShown({ side * (h + 0.5), height / 2, 0 }, { 1, height, 2 * h + 2 })
        addShown({ 0, height / 2, side * (h + 0.5) }, { 2 * h, height, 1 })
    end
end

local palette = {
    { 0.90, 0.36, 0.12 }, { 0.96, 0.62, 0.24 }, { 0.98, 0.86, 0.62 }, { 0.93, 0.93, 0.88 },
    { 0.36, 0.62, 0.68 }, { 0.16, 0.36, 0.52 },
}

local function addSpheres(m)
    for i = 0, n - 1 do
        local layer, cell = math.floor(i / (m * m)), i % (m * m)
        local x = (cell % m - (m - 1) / 2) * 1.1 + symmetric(0.04)
        local z = (math.floor(cell / m) - (m - 1) / 2) * 1.1 + symmetric(0.04)
        scene.spawn{
            position = { x, 1 + 1.1 * layer, z }, mesh = "sphere",
            color = palette[(layer + math.floor(3 * x * z)) % #palette + 1],
            body = { shape = "sphere", radius = 0.5, density = 1000, friction = 0.5 },
        }
    end
end

local function addLights(h, depth)
    gfx.setBackground(0.025, 0.03, 0.045)
    gfx.setAmbient(0.16, 0.18, 0.22)
    gfx.newLight{
        type = "directional", direction = { -0.45, -1, -0.3 },
        color = { 1, 0.95, 0.86 }, intensity = 2.6,
    }
    for i, color in ipairs{ { 1, 0.45, 0.2 }, { 0.25, 0.6, 1 } } do
        gfx.newLight{
            position = { (i * 2 - 3) * h * 0.7, depth + 4, h * 0.5 },
            color = color, intensity = 6 * h, radius = 2.5 * h + 6,
        }
    end
end

function corsac.load()
    state = corsac.getSeed() + 0ULL
    local m = math.ceil(n ^ (1 / 3) * 1.25)
    local h = m * 0.55 + 0.5
    local depth = 0.9 * n / (4 * h * h) -- of the settled pile, roughly
    phys.setGravity(0, -9.81, 0)
    addBin(h, depth + 1)
    addSpheres(m)
    addLights(h, depth)
    gfx.setCamera{
        position = { h * 1.9, depth + h * 1.5, h * 2.3 },
        target = { -h * 0.05, depth * 0.35, 0 },
        fov = 0.75, far = 10 * h + 60,
    }
    corsac.expect("accuracy.nan", "==", 0)
end
