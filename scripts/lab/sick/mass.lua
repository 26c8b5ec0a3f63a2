-- sick: mass ratio
-- A crate carries a safe that is 3,000 times as heavy.
function corsac.load()
    corsac.scene.spawn{
        position = { 0, -0.5, 0 }, mesh = "box",
        body = { type = "static", shape = "box", size = { 40, 1, 40 } },
    }
    for i, density in ipairs{ 1, 3000 } do
        corsac.scene.spawn{
            position = { 0, i - 0.5, 0 }, mesh = "box", name = i == 1 and "crate" or "safe",
            body = { shape = "box", size = { 1, 1, 1 }, density = density },
        }
    end
end
