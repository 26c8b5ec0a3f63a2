-- The white furnace: under a sky that is one everywhere, white things cannot be seen. What shows is
-- energy lost or made by the materials.
local gfx, scene = corsac.gfx, corsac.scene

function corsac.conf(t)
    t.steps = 2
    t.size = { 700, 200 }
end

function corsac.load()
    local white = { 1, 1, 1 }
    gfx.setEnvironment{ zenith = white, horizon = white, ground = white, glow = { 0, 0, 0 } }
    gfx.set("tonemap", "linear")
    gfx.set("exposure", "0.5")
    for row = 0, 1 do
        for i = 0, 6 do
            scene.spawn{ mesh = "sphere", position = { (i - 3) * 1.1, row * 1.1 - 0.55, 0 },
                material = gfx.newMaterial{ metallic = row, roughness = i / 6 } }
        end
    end
    gfx.setCamera{ position = { 0, 0, 8 }, target = { 0, 0, 0 }, height = 2.4 }
end
