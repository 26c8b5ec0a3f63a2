-- Lamps at night: what is far brighter than the picture can show spills over; the exposure finds
-- its own level, fog lies on the ground.
local gfx, scene = corsac.gfx, corsac.scene
local strength = corsac.param("bloom", 0.12)

function corsac.conf(t)
    t.steps = 2
    t.size = { 960, 540 }
end

local function glowing(color, power)
    return gfx.newMaterial{ baseColor = { 0, 0, 0 }, roughness = 1,
        emissive = { color[1] * power, color[2] * power, color[3] * power } }
end

function corsac.load()
    gfx.set("bloom", strength)
    gfx.set("bloom_threshold", 1)
    gfx.set("bloom_levels", 7)
    gfx.set("auto_exposure", true)
    gfx.set("key", 0.12)
    gfx.set("fog", 0.06)
    gfx.set("fog_falloff", 0.9)
    gfx.set("fog_color", { 0.012, 0.016, 0.026 })
    gfx.set("fxaa", true)
    gfx.setAmbient(0.012, 0.015, 0.024)
    gfx.setBackground(0.004, 0.005, 0.009)
    local colors = { { 1, 0.55, 0.2 }, { 0.3, 0.65, 1 }, { 1, 0.25, 0.45 }, { 0.45, 1, 0.5 } }
    local wet = gfx.newMaterial{ baseColor = { 0.12, 0.12, 0.13 }, roughness = 0.35 }
    scene.spawn{ mesh = "plane", scale = { 600, 1, 600 }, material = wet }
    for i = 0, 11 do
        local color, side = colors[i % 4 + 1], i % 2 * 2 - 1
        local x, z = side * 2.2, 3 - 2.2 * math.floor(i / 2)
        scene.spawn{ mesh = "cylinder", position = { x, 0.8, z }, scale = { 0.08, 1.6, 0.08 },
            color = { 0.2, 0.2, 0.2 } }
        scene.spawn{ mesh = "sphere", position = { x, 1.7, z }, scale = { 0.24, 0.24, 0.24 },
            material = glowing(color, 14) }
        gfx.newLight{ position = { x, 1.7, z }, color = color, intensity = 2.4, radius = 8 }
        scene.spawn{ mesh = "box", position = { side * 4.4, 1 + i % 3 * 0.5, z },
            scale = { 1.8, 2 + i % 3, 1.7 }, color = { 0.5, 0.5, 0.52 } }
    end
    gfx.setCamera{ position = { 0, 1.5, 6.4 }, target = { 0, 1.2, 0 }, fov = 0.9 }
end
