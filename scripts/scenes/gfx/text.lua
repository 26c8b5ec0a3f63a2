-- A sheet of text: sizes, faces, alignment, lines that break, kerning, many scripts, clips and
-- sprites over the frame, and names in the world.
local gfx, scene = corsac.gfx, corsac.scene
local INK, DIM, FIRE = { 0.94, 0.95, 0.97 }, { 0.62, 0.66, 0.74 }, { 0.98, 0.62, 0.22 }
local STORY = "A corsac is a small fox of the steppe. It is light, it runs far, and it hears what moves "
    .. "under the snow before anything shows."

function corsac.conf(t)
    t.steps = 1
    t.size = { 960, 540 }
end

function corsac.load()
    gfx.setBackground(0.02, 0.024, 0.034)
    scene.spawn{ mesh = "box", position = { 3, -0.55, 0 }, scale = { 9, 1, 9 }, color = { 0.4, 0.45, 0.5 } }
    for i = 1, 3 do
        scene.spawn{ mesh = i == 2 and "capsule" or "sphere", position = { 2 + i, 0.5, 1.2 * i - 3 },
            color = { 0.9, 0.3 + 0.2 * i, 0.2 } }
    end
    gfx.newLight{ type = "directional", direction = { -1, -2, -1 }, intensity = 3 }
    gfx.setCamera{ position = { 1, 3.4, 10.5 }, target = { 1, 2.2, 0 } }
end

local function column(x, y, width, align)
    local _, high = gfx.measure(STORY, { size = 16, width = width, font = "sans" })
    gfx.roundRect(x - 8, y - 8, width + 16, high + 16, 6, { 1, 1, 1, 0.05 })
    gfx.text(STORY, { x = x, y = y, size = 16, width = width, align = align, font = "sans", color = INK })
end

local function overFrame()
    local y = 14
    for _, size in ipairs{ 11, 14, 18, 24, 33, 46 } do
        gfx.text("Corsac " .. size, { x = 20, y = y, size = size, font = "sans", color = INK })
        gfx.text("Corsac " .. size, { x = 260, y = y, size = size, color = DIM })
        y = y + size + 4
    end
    gfx.text("AVAToW Yo. Tea", { x = 500, y = 14, size = 33, font = "sans", color = FIRE })
    gfx.text("éüß żółć Лиса αλεπού ← ½ € ☃ \255", { x = 500, y = 58, size = 20, font = "sans", color = INK })
    column(510, 100, 130, 0)
    column(670, 100, 130, 0.5)
    column(830, 100, 110, 1)
    local wide, high, lines = gfx.measure(STORY, { size = 16, width = 130, font = "sans" })
    gfx.print(("%.1f x %d pixels, %d lines"):format(wide, high, lines), 502, 236, 14, DIM)
    gfx.pushClip(20, 190, 300, 26)
    gfx.text("Cut by its clip", { x = 40, y = 180, size = 40, font = "sans", color = FIRE })
    gfx.popClip()
    for i = 0, 7 do
        gfx.line(30 + 36 * i, 240, 50 + 36 * i, 280, 1 + i, FIRE)
        gfx.roundRect(30 + 36 * i, 296, 28, 28, 2 * i, i % 2 == 0 and INK or DIM, i > 3 and i - 2 or 0)
        gfx.sprite("images/coin.png", { x = 44 + 36 * i, y = 364, w = 34, h = 34, source = { 64 * i, 0, 64, 64 },
            pivotX = 0.5, pivotY = 0.5, angle = 0.2 * i, color = { 1, 1, 1, 1 - 0.08 * i } })
    end
end

function corsac.draw()
    overFrame()
    for i, name in ipairs{ "north", "middle", "south" } do
        gfx.drawText(name, { position = { 2 + i, 1.5 + (i == 2 and 0.5 or 0), 1.2 * i - 3 }, height = 0.5,
            font = "sans" })
        gfx.drawSprite("images/coin.png", { position = { 0.2 + i, 0.5, 2.4 }, source = { 64 * i, 0, 64, 64 } })
    end
    gfx.drawText("painted on\nthe ground", { position = { 5.2, -0.04, 2.4 }, height = 0.6, facing = "fixed",
        rotation = { axis = { 1, 0, 0 }, angle = -math.pi / 2 }, font = "sans", color = { 0.05, 0.05, 0.1 } })
    gfx.drawText("upright", { position = { 0.4, 0.6, -1.5 }, height = 0.6, facing = "upright",
        color = { 0.8, 0.2, 0.05 } })
end
