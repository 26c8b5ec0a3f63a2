-- Soft shadows: bars at growing height under a sun with a wide disk; penumbrae widen with height.
local gfx, scene = corsac.gfx, corsac.scene
local source = corsac.param("source", 0.12)

function corsac.conf(t)
    t.steps = 2
    t.size = { 960, 540 }
end

function corsac.load()
    gfx.set("shadows", "soft")
    gfx.set("shadow_size", "2048")
    gfx.setAmbient(0.12, 0.13, 0.16)
    gfx.setBackground(0.5, 0.56, 0.65)
    scene.spawn{ mesh = "plane", scale = { 30, 1, 30 }, color = { 0.8, 0.8, 0.78 } }
    for i = -3, 3 do -- the higher the bar, the wider its penumbra
        local h = 0.6 + (i + 3) * 0.55
        scene.spawn{ mesh = "box", position = { i * 1.6, h, 0 }, scale = { 0.5, 0.18, 3 }, color = { 0.8, 0.36, 0.2 } }
        scene.spawn{ mesh = "cylinder", position = { i * 1.6, h / 2, 1.2 }, scale = { 0.1, h, 0.1 },
            color = { 0.4, 0.4, 0.42 } }
    end
    gfx.newLight{ type = "directional", direction = { -0.35, -1, -0.55 }, intensity = 2.6, source = source }
    gfx.setCamera{ position = { 0, 7, 9.5 }, target = { 0, 0.7, -0.6 }, fov = 0.8 }
end
