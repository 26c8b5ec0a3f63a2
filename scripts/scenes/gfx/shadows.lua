-- Shadows of a sun, a spot and a point light. filter: pcf or soft; source: size of the sources.
local filter = corsac.param("filter", "soft")
local source = corsac.param("source", 0.15)
local gfx, scene = corsac.gfx, corsac.scene

function corsac.conf(t)
    t.steps = 2
    t.size = { 960, 540 }
end

function corsac.load()
    gfx.set("shadows", filter)
    gfx.setAmbient(0.1, 0.11, 0.13)
    gfx.setBackground(0.02, 0.025, 0.035)
    scene.spawn{ mesh = "plane", scale = { 40, 1, 40 }, color = { 0.7, 0.7, 0.7 } }
    for i = 0, 8 do
        local a = i * 0.698
        scene.spawn{ mesh = "box", position = { 4 * math.cos(a), 1 + i * 0.12, 4 * math.sin(a) },
            scale = { 0.3, 2 + i * 0.24, 0.3 }, color = { 0.75, 0.5, 0.3 } }
    end
    scene.spawn{ mesh = "sphere", position = { 0, 1, 0 }, scale = { 2, 2, 2 }, color = { 0.85, 0.85, 0.85 } }
    gfx.newLight{ type = "directional", direction = { -0.7, -0.6, -0.4 }, intensity = 1.6, source = source * 0.4 }
    gfx.newLight{ type = "spot", position = { -6, 6, 5 }, direction = { 0.7, -0.75, -0.55 }, radius = 30,
        intensity = 90, inner = 0.3, outer = 0.5, color = { 1, 0.7, 0.4 }, shadows = true, source = source }
    gfx.newLight{ position = { 2.2, 1.4, 2 }, radius = 12, intensity = 7, color = { 0.4, 0.6, 1 },
        shadows = true, source = source }
    gfx.setCamera{ position = { 1, 7, 10 }, target = { 0, 0.6, 0 }, fov = 0.85 }
end
