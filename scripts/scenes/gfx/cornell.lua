-- The Cornell box, lit by a spot that hangs under its ceiling: direct light only.
local gfx, scene = corsac.gfx, corsac.scene

function corsac.conf(t)
    t.steps = 2
    t.size = { 600, 600 }
end

local function wall(position, scale, color)
    scene.spawn{ mesh = "box", position = position, scale = scale, color = color }
end

function corsac.load()
    local white, red, green = { 0.73, 0.73, 0.73 }, { 0.65, 0.05, 0.05 }, { 0.12, 0.45, 0.15 }
    gfx.set("shadows", "soft")
    gfx.setAmbient(0.06, 0.055, 0.05)
    gfx.setBackground(0, 0, 0)
    wall({ 0, -0.05, 0 }, { 5.6, 0.1, 5.6 }, white)
    wall({ 0, 5.55, 0 }, { 5.6, 0.1, 5.6 }, white)
    wall({ 0, 2.75, -2.85 }, { 5.6, 5.6, 0.1 }, white)
    wall({ -2.85, 2.75, 0 }, { 0.1, 5.6, 5.6 }, red)
    wall({ 2.85, 2.75, 0 }, { 0.1, 5.6, 5.6 }, green)
    scene.spawn{ mesh = "box", position = { 0.95, 0.83, 0.8 }, scale = { 1.65, 1.65, 1.65 }, color = white,
        rotation = { axis = { 0, 1, 0 }, angle = -0.29 } }
    scene.spawn{ mesh = "box", position = { -0.95, 1.65, -0.6 }, scale = { 1.65, 3.3, 1.65 }, color = white,
        rotation = { axis = { 0, 1, 0 }, angle = 0.3 } }
    gfx.newLight{ type = "spot", position = { 0, 5.45, 0 }, direction = { 0, -1, 0 }, radius = 20,
        intensity = 22, inner = 0.9, outer = 1.45, color = { 1, 0.82, 0.55 }, shadows = true, source = 0.5 }
    gfx.setCamera{ position = { 0, 2.75, 10.5 }, target = { 0, 2.75, 0 }, fov = 0.68 }
end
