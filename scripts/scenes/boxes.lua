-- A pyramid of unit cubes that touch sideways: scene S2 of the engine comparison. n: cubes in the
-- bottom row.
local n = corsac.param("n", 20)

function corsac.load()
    local scene, gfx = corsac.scene, corsac.gfx
    corsac.phys.setGravity(0, -9.81, 0)
    scene.spawn{
        position = { 0, -1, 0 }, mesh = "box", color = { 0.42, 0.45, 0.52 },
        body = { type = "static", shape = "box", size = { 400, 2, 400 } },
    }
    for row = 0, n - 1 do
        for column = 0, n - row - 1 do
            local warm, shade = row / n, (row + column) % 2 == 0 and 1 or 0.8
            scene.spawn{
                position = { column - (n - row - 1) / 2, 0.5 + row, 0 }, mesh = "box",
                color = {
                    shade * (0.95 - 0.2 * warm), shade * (0.42 + 0.45 * warm),
                    shade * (0.16 + 0.6 * warm),
                },
                body = { shape = "box", size = { 1, 1, 1 }, density = 1000, friction = 0.5 },
            }
        end
    end
    gfx.setBackground(0.025, 0.03, 0.045)
    gfx.setAmbient(0.16, 0.18, 0.22)
    gfx.newLight{
        type = "directional", direction = { -0.5, -1, -0.6 },
        color = { 1, 0.95, 0.86 }, intensity = 2.8,
    }
    gfx.setCamera{
        position = { n * 0.7, n * 0.6, n * 1.35 }, target = { 0, n * 0.43, 0 },
        fov = 0.9, far = 6 * n + 60,
    }
    corsac.expect("accuracy.nan", "==", 0)
end
