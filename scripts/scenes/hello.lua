function corsac.load()
    corsac.phys.setGravity(0, -9.81, 0)
    corsac.scene.spawn{ position = { 0, -0.5, 0 }, mesh = "box",
        body = { type = "static", shape = "box", size = { 20, 1, 20 } } }
    for i = 1, corsac.param("n", 100) do
        corsac.scene.spawn{ position = { 0.1 * (i % 3), 1.1 * i, 0 }, mesh = "sphere",
            body = { shape = "sphere", radius = 0.5, density = 1000 } }
    end
end
