-- A range of hills from a field of heights, under the sky. points: of the field along an edge;
-- error: pixels that it may be off; view: where the eye is, in turns about the middle.
local points = corsac.param("points", 513)
local tolerance = corsac.param("error", 1)
local view = corsac.param("view", 0)

local gfx = corsac.gfx
local STEP = 2 -- m

function corsac.conf(t)
    t.steps = 1
    t.size = { 960, 540 }
end

-- Value noise: a lattice of random numbers, smoothly joined.
local function newNoise(side)
    local values = {}
    for i = 1, side * side do values[i] = math.random() end
    local function at(x, z) return values[(z % side) * side + x % side + 1] end
    return function(x, z)
        local i, k = math.floor(x), math.floor(z)
        local u, v = x - i, z - k
        u, v = u * u * u * (u * (6 * u - 15) + 10), v * v * v * (v * (6 * v - 15) + 10)
        local a, b = at(i, k), at(i, k + 1)
        a, b = a + (at(i + 1, k) - a) * u, b + (at(i + 1, k + 1) - b) * u
        return a + (b - a) * v
    end
end

-- Octaves of folded noise: ridges, each finer one stronger where the ones before are high.
local function newHeights(n)
    local noise, heights = newNoise(64), {}
    for row = 0, n - 1 do
        for column = 0, n - 1 do
            local x, z = column / n * 4, row / n * 4
            local height, size, weight, share = 0, 1, 1, 1
            for _ = 1, 8 do
                local fold = 2 * noise(x * size + 3.7 * size, z * size) - 1
                local ridge = 1 - math.sqrt(fold * fold + 0.01)
                height = height + ridge * ridge * weight * share
                share = math.min(1, share * (0.3 + ridge))
                size, weight = size * 2.03, weight * 0.44
            end
            heights[#heights + 1] = 105 * height - 60
        end
    end
    return heights
end

function corsac.load()
    local half = 0.5 * STEP * (points - 1)
    local terrain = gfx.newTerrain{ heights = newHeights(points), columns = points, step = { STEP },
        position = { -half, 0, -half }, heightsBlend = { 45, 75 }, slopesBlend = { 0.55, 0.95 } }
    gfx.set("terrain_error", tostring(tolerance))
    gfx.set("shadow_distance", "900")
    gfx.setEnvironment{ intensity = 0.8, sun = { 0.6, 0.45, 0.5 } }
    gfx.newLight{ type = "directional", direction = { -0.6, -0.45, -0.5 }, intensity = 4, color = { 1, 0.9, 0.75 } }
    local turn = 2 * math.pi * view
    local x, z = 0.8 * half * math.cos(turn), 0.8 * half * math.sin(turn)
    local y = terrain:getHeight(x, z) + 45
    gfx.setCamera{ position = { x, y, z }, target = { 0, y - 60, 0 }, far = 2000, near = 0.5 }
end
