-- Balls of radius 0.5 m dropped into a bin: an ensemble without a known trajectory, judged by what
-- every state must fulfil (bodies do not overlap, nothing leaves the bin).
local n = corsac.param("n", 300)
local scene = corsac.scene
local balls = {}

local function wall(position, size)
    scene.spawn{ position = position, body = { type = "static", shape = "box", size = size } }
end

function corsac.load()
    local m = math.ceil(n ^ (1 / 3))
    local h = 0.56 * m + 0.3 -- half the inner width
    wall({ 0, -1, 0 }, { 2 * h + 4, 2, 2 * h + 4 })
    for _, side in ipairs{ 1, -1 } do
        wall({ side * (h + 0.5), 20, 0 }, { 1, 40, 2 * h + 2 })
        wall({ 0, 20, side * (h + 0.5) }, { 2 * h + 2, 40, 1 })
    end
    for i = 0, n - 1 do
        local cell = i % (m * m)
        balls[i + 1] = scene.spawn{
            position = {
                (cell % m - (m - 1) / 2) * 1.1 + 0.04 * (2 * math.random() - 1),
                0.6 + 1.1 * math.floor(i / (m * m)),
                (math.floor(cell / m) - (m - 1) / 2) * 1.1 + 0.04 * (2 * math.random() - 1),
            },
            mesh = "sphere", body = { shape = "sphere", radius = 0.5, density = 1000, friction = 0.5 },
        }
    end
end

function corsac.quit()
    local lost = 0
    for _, ball in ipairs(balls) do
        local _, y = ball:getPosition()
        if y <= 0 or y ~= y then lost = lost + 1 end
    end
    corsac.metrics.set("lost", lost)
end
