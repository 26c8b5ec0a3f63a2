-- args: --steps 240
-- Ground that is drawn and ground that is walked on are the same triangles: rays against the height
-- that the terrain says, and balls that come to rest on it.
local gfx, phys, scene = corsac.gfx, corsac.phys, corsac.scene
local COLUMNS, ROWS = 33, 41
local terrain
local balls, worst = {}, 0

local function near(x, z)
    local _, _, y = phys.rayCast(x, 50, z, 0, -100, 0)
    worst = math.max(worst, math.abs(y - terrain:getHeight(x, z)))
end

function corsac.load()
    local heights = {}
    for _ = 1, COLUMNS * ROWS do heights[#heights + 1] = 2 * math.random() end
    local place = { -16, 1, -25 }
    terrain = gfx.newTerrain{ heights = heights, columns = COLUMNS, step = { 1, 1.25 }, position = place }
    scene.spawn{ position = place, body = { type = "static", shape = "mesh", heights = heights,
        columns = COLUMNS, step = { 1, 1.25 } } }
    for _ = 1, 400 do near(30 * math.random() - 15, 48 * math.random() - 24) end
    for i = 1, 12 do
        balls[i] = scene.spawn{ position = { 2 * i - 13, 6, i - 6 }, body = { shape = "sphere", radius = 0.4 } }
    end
    corsac.metrics.set("apart", worst)
    corsac.metrics.set("beside", terrain:getHeight(40, 0) and 1 or 0)
end

function corsac.fixed()
    local least = math.huge
    for _, ball in ipairs(balls) do
        local x, y, z = ball:getPosition()
        least = math.min(least, y - (terrain:getHeight(x, z) or y))
    end
    corsac.metrics.set("least", least)
end

corsac.expect("user.apart", "<", 1e-4)
corsac.expect("user.beside", "==", 0)
corsac.expect("user.least", ">", 0.39)
