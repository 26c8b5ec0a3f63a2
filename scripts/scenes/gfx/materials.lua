-- Spheres of growing roughness, plastic below and metal above, under a sky.
local gfx, scene = corsac.gfx, corsac.scene
local columns = corsac.param("columns", 7)

function corsac.conf(t)
    t.steps = 2
    t.size = { 960, 540 }
end

function corsac.load()
    gfx.setEnvironment{ sun = { 0.5, 0.6, 0.6 }, glow = { 5, 4.2, 3 }, glowExponent = 60 }
    gfx.newLight{ type = "directional", direction = { -0.5, -0.6, -0.6 }, color = { 1, 0.95, 0.85 }, intensity = 3 }
    local floor = gfx.newMaterial{ baseColor = { 0.35, 0.35, 0.36 }, roughness = 0.7 }
    scene.spawn{ mesh = "plane", scale = { 40, 1, 40 }, material = floor }
    local rows = {
        { baseColor = { 0.9, 0.12, 0.08 }, metallic = 0 },
        { baseColor = { 1, 0.77, 0.34 }, metallic = 1 },
        { baseColor = { 0.95, 0.95, 0.96 }, metallic = 1 },
    }
    for row, kind in ipairs(rows) do
        for i = 1, columns do
            kind.roughness = (i - 1) / (columns - 1)
            scene.spawn{
                mesh = "sphere", position = { (i - (columns + 1) / 2) * 1.15, 0.5 + (row - 1) * 1.1, 0 },
                material = gfx.newMaterial(kind),
            }
        end
    end
    gfx.setCamera{ position = { 0, 1.9, 7.2 }, target = { 0, 1.55, 0 }, fov = 0.75 }
end
