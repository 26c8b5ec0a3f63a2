-- Shaders of the game's own: a material whose file ripples a pool, and a pass over the picture that
-- draws lines where depth leaps.
local gfx, scene = corsac.gfx, corsac.scene
local lines = corsac.param("lines", 0.85)
local water

function corsac.conf(t)
    t.steps = 90
    t.size = { 960, 540 }
end

function corsac.load()
    gfx.setEnvironment{ sun = { 0.4, 0.5, -0.5 } }
    gfx.newLight{ type = "directional", direction = { -0.4, -0.8, 0.5 }, intensity = 2.5 }
    gfx.set("fxaa", true)
    water = gfx.newMaterial{ fragment = "ripples.glsl", baseColor = { 0.02, 0.1, 0.12 },
        roughness = 0.06, parameters = { 0, 0.12 } }
    scene.spawn{ mesh = "plane", position = { 0, -0.12, 0 }, scale = { 6, 1, 6 }, material = water }
    for i = 0, 3 do
        local angle = i * math.pi / 2
        scene.spawn{ mesh = "box", scale = { 7, 0.6, 0.5 }, color = { 0.7, 0.66, 0.6 },
            position = { 3.25 * math.sin(angle), -0.1, 3.25 * math.cos(angle) },
            rotation = { axis = { 0, 1, 0 }, angle = angle } }
    end
    for i = 0, 6 do
        local angle = i * math.pi / 3.5
        scene.spawn{ mesh = i % 2 == 0 and "sphere" or "capsule", scale = { 0.8, 0.8, 0.8 },
            position = { 1.9 * math.cos(angle), 0.2, 1.9 * math.sin(angle) },
            color = { 0.85, 0.35 + 0.08 * i, 0.2 } }
    end
    gfx.newEffect{ fragment = "outlines.glsl", encoded = true, parameters = { lines } }
    gfx.setCamera{ position = { 3.4, 2.6, 5.6 }, target = { 0, 0, 0 }, fov = 0.8 }
end

function corsac.update()
    water:setParameters{ corsac.getTime(), 0.12 }
end
