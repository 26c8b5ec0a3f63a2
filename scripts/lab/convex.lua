-- n balls of radius 0.25 m rain onto a fixed convex body (a cut gem of 24 points) and roll off it.
local n = corsac.param("n", 200)
local points = {}

function corsac.load()
    for ring = 0, 2 do
        for i = 0, 7 do
            local angle, r = (i + ring / 2) * math.pi / 4, ring == 1 and 6 or 3.5
            points[#points + 1] = r * math.cos(angle)
            points[#points + 1] = 1.5 * (ring - 1)
            points[#points + 1] = r * math.sin(angle)
        end
    end
    corsac.scene.spawn{
        position = { 0, 2, 0 },
        body = { type = "static", shape = "hull", points = points, friction = 0.5 },
    }
    corsac.scene.spawn{
        position = { 0, -0.5, 0 }, body = { type = "static", shape = "box", size = { 80, 1, 80 } },
    }
    for i = 0, n - 1 do
        local cell = i % 64
        corsac.scene.spawn{
            position = {
                (cell % 8 - 3.5) * 0.7 + 0.02 * math.random(), 5 + 0.6 * math.floor(i / 64),
                (math.floor(cell / 8) - 3.5) * 0.7 + 0.02 * math.random(),
            },
            mesh = "sphere", body = { shape = "sphere", radius = 0.25, density = 1000, friction = 0.5 },
        }
    end
end
