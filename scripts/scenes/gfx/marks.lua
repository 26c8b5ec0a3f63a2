-- Lines and shapes drawn in the world for one frame: what physics and navigation show themselves with.
local gfx, scene = corsac.gfx, corsac.scene
local balls = {}

function corsac.conf(t)
    t.steps = 90
    t.size = { 960, 540 }
end

function corsac.load()
    scene.spawn{ mesh = "box", position = { 0, -0.5, 0 }, color = { 0.35, 0.38, 0.42 },
        body = { type = "static", shape = "box", size = { 20, 1, 20 } } }
    for i = 1, 6 do
        balls[i] = scene.spawn{ mesh = "sphere", position = { i - 3.5, 2 + 0.7 * i, 0.3 * i - 1 },
            color = { 0.8, 0.5, 0.3 }, body = { shape = "sphere", radius = 0.4 } }
    end
    gfx.newLight{ type = "directional", direction = { -1, -2, -0.6 }, intensity = 3 }
    gfx.setCamera{ position = { 5, 4.5, 8 }, target = { 0, 0.8, 0 } }
end

function corsac.draw()
    gfx.drawGrid({ 0, 0.002, 0 }, 16, 16, { color = { 0.7, 0.75, 0.85, 0.5 }, width = 1 })
    for i, ball in ipairs(balls) do
        local x, y, z = ball:getPosition()
        gfx.drawSphere({ x, y, z }, 0.45, { color = { 0.2, 0.9, 0.4 }, width = 2 })
        gfx.drawArrow({ x, y, z }, { x, y + 0.8 + 0.1 * i, z }, { color = { 1, 0.9, 0.2 }, width = 3, onTop = true })
    end
    gfx.drawBox({ -4, 1, -2 }, { 1.5, 2, 1 }, { color = { 0.2, 0.6, 1 }, width = 2 },
        { axis = { 0, 1, 0 }, angle = 0.6 })
    gfx.drawBox({ -6, 1, 0 }, { 1, 1, 1 })
    gfx.drawCapsule({ 4, 0.5, -2 }, { 4, 1.8, -3 }, 0.5, { color = { 1, 0.3, 0.7 }, width = 2 })
    gfx.drawPath({ -6, 0.1, 4, -3, 0.1, 3, -1, 0.1, 5, 2, 0.1, 3, 5, 0.1, 4 },
        { color = { 0.1, 1, 0.9 }, width = 4 })
    gfx.drawLine({ 0, 3, 20 }, { 0, 0, -9 }, { color = { 1, 0.2, 0.1 }, width = 2 }) -- from behind the eye
end
