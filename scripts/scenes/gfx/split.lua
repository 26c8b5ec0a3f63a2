-- Split screen: two players' views above each other, a plan of the room beside them, and in the
-- room a screen that shows what its camera sees.
local gfx, scene = corsac.gfx, corsac.scene
local views = {}

function corsac.conf(t)
    t.steps = 40
    t.size = { 960, 540 }
end

function corsac.load()
    gfx.setAmbient(0.25, 0.27, 0.3)
    gfx.newLight{ type = "directional", direction = { -0.5, -1, -0.35 }, intensity = 2.4 }
    scene.spawn{ mesh = "box", position = { 0, -0.1, 0 }, scale = { 12, 0.2, 12 },
        color = { 0.5, 0.52, 0.5 } }
    for i = 0, 15 do
        local angle = i * math.pi / 8
        scene.spawn{ mesh = i % 2 == 0 and "cylinder" or "box",
            scale = { 0.6, 1.2 + 0.6 * (i % 3), 0.6 },
            position = { 4.6 * math.cos(angle), 0.6 + 0.3 * (i % 3), 4.6 * math.sin(angle) },
            color = { 0.4 + 0.4 * math.cos(angle), 0.5, 0.5 + 0.4 * math.sin(angle) } }
    end
    scene.spawn{ mesh = "sphere", position = { 1, 0.6, 0.4 }, scale = { 1.2, 1.2, 1.2 },
        color = { 0.9, 0.5, 0.2 } }
    -- The screen: a glowing plane that stands upright.
    gfx.newView{ texture = "monitor", size = { 256, 144 }, position = { 3, 2.5, 3 },
        target = { 1, 0.5, 0 } }
    local glow = gfx.newMaterial{ baseColor = { 0, 0, 0 }, emissive = { 1, 1, 1 },
        emissiveMap = "target:monitor" }
    scene.spawn{ mesh = "plane", position = { -1.2, 1.4, -1.6 }, scale = { 3.2, 1, 1.8 },
        material = glow, rotation = { axis = { 1, 0, 0 }, angle = math.pi / 2 } }
    scene.spawn{ mesh = "box", position = { -1.2, 1.4, -1.66 }, scale = { 3.4, 2, 0.1 },
        color = { 0.1, 0.1, 0.1 } }
    views[1] = gfx.newView{ rect = { 0, 0, 0.7, 0.5 } }
    views[2] = gfx.newView{ rect = { 0, 0.5, 0.7, 0.5 } }
    gfx.newView{ rect = { 0.7, 0, 0.3, 1 }, position = { 0, 9, 0 }, target = { 0, 0, 0 },
        height = 13 }
end

local eye = { position = { 0, 1.7, 0 }, target = { 0, 0.8, 0 } } -- written over: a frame makes no garbage

function corsac.update()
    local turn = 0.01 * corsac.getStep()
    for i, view in ipairs(views) do
        local angle = turn + (i - 1) * 4.1 + 0.9
        eye.position[1], eye.position[3] = 4.2 * math.cos(angle), 4.2 * math.sin(angle)
        view:setCamera(eye)
    end
end

function corsac.draw()
    gfx.print("one", 12, 8, 20)
    gfx.print("two", 12, 278, 20)
    gfx.print("plan", 684, 8, 20)
end
