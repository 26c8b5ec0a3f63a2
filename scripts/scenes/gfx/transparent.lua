-- Panes of coloured glass before each other and before a lamp: drawn from far to near, whatever the
-- order in which they were made; every ray keeps what each pane lets through.
local gfx, scene = corsac.gfx, corsac.scene
local panes = corsac.param("panes", 9)

function corsac.conf(t)
    t.steps = 2
    t.size = { 960, 540 }
end

function corsac.load()
    gfx.setEnvironment{ sun = { 0.3, 0.5, 0.6 } }
    gfx.newLight{ type = "directional", direction = { -0.4, -1, -0.5 }, intensity = 2 }
    gfx.set("msaa", "4")
    local tile = { { 0.75, 0.74, 0.7 }, { 0.3, 0.32, 0.35 } }
    for i = 0, 63 do
        scene.spawn{ mesh = "box", position = { i % 8 - 3.5, -0.1, math.floor(i / 8) - 5.5 },
            scale = { 1, 0.2, 1 }, color = tile[(i + math.floor(i / 8)) % 2 + 1] }
    end
    local lamp = gfx.newMaterial{ baseColor = { 1, 0.8, 0.5 }, emissive = { 1.5, 1.1, 0.6 } }
    scene.spawn{ mesh = "sphere", position = { 0, 1, -5 }, scale = { 1.2, 1.2, 1.2 }, material = lamp }
    local colors = { { 0.9, 0.2, 0.15, 0.35 }, { 0.15, 0.7, 0.3, 0.35 }, { 0.15, 0.3, 0.9, 0.35 } }
    for k = 0, panes - 1 do
        local i = k * 4 % panes -- not in their order
        local glass = gfx.newMaterial{ baseColor = colors[i % 3 + 1], alpha = "blend",
            roughness = 0.1, doubleSided = true }
        scene.spawn{ mesh = "box", material = glass, scale = { 2, 1.8, 0.05 },
            position = { 0.28 * (i - (panes - 1) / 2), 1, 1.5 - 0.6 * i },
            rotation = { axis = { 0, 1, 0 }, angle = 0.12 * (i - 4) } }
    end
    gfx.setCamera{ position = { 2.6, 2, 5 }, target = { 0, 0.9, -1 }, fov = 0.8 }
end
