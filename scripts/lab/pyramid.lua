-- A pyramid of unit cubes that touch sideways; n: cubes in the bottom row. The exact height of the
-- top one is n - 0.5 m.
local n = corsac.param("n", 12)
local scene = corsac.scene
local top

function corsac.load()
    scene.spawn{
        position = { 0, -1, 0 }, mesh = "box",
        body = { type = "static", shape = "box", size = { 400, 2, 400 } },
    }
    for row = 0, n - 1 do
        for column = 0, n - row - 1 do
            top = scene.spawn{
                position = { column - (n - row - 1) / 2, 0.5 + row, 0 }, mesh = "box",
                body = { shape = "box", size = { 1, 1, 1 }, density = 1000, friction = 0.5 },
            }
        end
    end
end

function corsac.quit()
    local x, y, z = top:getPosition()
    corsac.metrics.set("sag_mm", 1000 * math.abs(n - 0.5 - y))
    corsac.metrics.set("drift_mm", 1000 * math.sqrt(x * x + z * z))
end
