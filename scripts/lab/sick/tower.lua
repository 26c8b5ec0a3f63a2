-- sick: stack height
-- A tower of 200 cubes with the default effort.
function corsac.load()
    corsac.scene.spawn{
        position = { 0, -0.5, 0 }, mesh = "box",
        body = { type = "static", shape = "box", size = { 40, 1, 40 } },
    }
    for i = 1, 200 do
        corsac.scene.spawn{
            position = { 0, i - 0.5, 0 }, mesh = "box",
            body = { shape = "box", size = { 1, 1, 1 } },
        }
    end
end
