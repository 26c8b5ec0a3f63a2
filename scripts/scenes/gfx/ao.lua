-- A corner full of things under an overcast sky: ambient light alone, darkened where it is shut out.
local gfx, scene = corsac.gfx, corsac.scene
local strength = corsac.param("ao", 1)
local radius = corsac.param("radius", 0.6)

function corsac.conf(t)
    t.steps = 2
    t.size = { 960, 540 }
end

local function box(position, scale, color, angle)
    scene.spawn{ mesh = "box", position = position, scale = scale, color = color,
        rotation = { axis = { 0, 1, 0 }, angle = angle or 0 } }
end

function corsac.load()
    gfx.set("ao", strength)
    gfx.set("ao_radius", radius)
    gfx.set("ao_slices", 4)
    gfx.set("ao_steps", 6)
    gfx.set("msaa", "4")
    gfx.setAmbient(0.75, 0.75, 0.76)
    gfx.setBackground(0.6, 0.62, 0.65)
    local plaster, wood = { 0.8, 0.79, 0.76 }, { 0.62, 0.5, 0.36 }
    box({ 0, -0.1, 0 }, { 8, 0.2, 8 }, plaster)
    box({ -2.1, 1.5, 0 }, { 0.2, 5, 8 }, plaster)
    box({ 0, 1.5, -2.1 }, { 8, 5, 0.2 }, plaster)
    for i = 0, 4 do -- stairs along the wall
        box({ -1.85 + 0.3 * i, 0.12 * (5 - i) / 2, -1.7 }, { 0.3, 0.12 * (5 - i), 0.6 }, wood)
    end
    for i = 0, 3 do -- a shelf
        box({ -1.85, 0.55 + 0.45 * i, 0.6 }, { 0.3, 0.05, 1.4 }, wood)
    end
    for i = 1, 9 do
        scene.spawn{ mesh = i % 3 == 0 and "cylinder" or "sphere",
            position = { -1.84, 0.7 + 0.45 * (i % 3), 0.05 + 0.14 * i },
            scale = { 0.22, 0.22, 0.22 }, color = { 0.75, 0.7, 0.62 } }
    end
    for i = 1, 6 do
        scene.spawn{ mesh = "sphere", scale = { 0.5, 0.5, 0.5 },
            position = { 0.2 + 0.45 * (i % 3), 0.25, -0.9 + 0.5 * (i % 2) }, color = { 0.72, 0.76, 0.8 } }
    end
    box({ -0.7, 0.3, 0.2 }, { 0.6, 0.6, 0.6 }, { 0.75, 0.72, 0.66 }, 0.5)
    box({ -0.7, 0.8, 0.2 }, { 0.4, 0.4, 0.4 }, { 0.75, 0.72, 0.66 }, 1.0)
    gfx.setCamera{ position = { 2.3, 1.9, 2.9 }, target = { -0.7, 0.5, -0.5 }, fov = 0.85 }
end
