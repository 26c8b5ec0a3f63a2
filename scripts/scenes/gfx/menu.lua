-- A menu of every widget over a turning scene: pointer, keys and gamepad drive it, and so does a
-- bot with --set bot=true.
local bot = corsac.param("bot", false)

local gfx, input, scene = corsac.gfx, corsac.input, corsac.scene
local menu, ball
local heard = {} -- names of what was pressed, in order

function corsac.conf(t)
    t.steps = 60
    t.size = { 960, 540 }
    t.actions = { back = "escape" }
end

local function press(name)
    return function() heard[#heard + 1] = name end
end

function corsac.load()
    gfx.setEnvironment{ intensity = 0.7 }
    gfx.newLight{ type = "directional", direction = { -1, -2, -1 }, intensity = 3 }
    scene.spawn{ mesh = "box", position = { 0, -0.5, 0 }, scale = { 30, 1, 30 }, color = { 0.4, 0.45, 0.5 } }
    ball = scene.spawn{ mesh = "sphere", position = { 2.2, 1, 0 }, scale = { 2, 2, 2 }, color = { 0.9, 0.5, 0.2 } }
    for i = 1, 9 do
        local a = i * 0.7
        scene.spawn{ mesh = "box", position = { 2.2 + 4 * math.cos(a), 0.4, 4 * math.sin(a) },
            scale = { 0.8, 0.8, 0.8 }, color = { 0.3, 0.5 + 0.05 * i, 0.7 } }
    end
    gfx.setCamera{ position = { -2, 3, 8 }, target = { 0, 1, 0 } }
    menu = corsac.ui.newPanel{
        x = 40, y = 34, width = 380, title = "Corsac", cancel = press("cancel"),
        { type = "button", name = "start", text = "Start", press = press("start") },
        { type = "field", name = "player", text = "Player", value = "Foxé", max = 12, enter = press("player") },
        { type = "slider", name = "volume", text = "Volume", value = 0.7, step = 0.05, format = "%.2f" },
        { type = "toggle", name = "shadows", text = "Shadows", value = true,
            change = function(on) gfx.set("shadows", on and "pcf" or "off") end },
        { type = "list", name = "level", rows = 3, value = 2,
            items = { "The den", "The river", "The ridge", "The long night", "Home" }, press = press("level") },
        { type = "button", name = "quit", text = "Leave", press = press("quit") },
    }
end

function corsac.event(...) menu:event(...) end

function corsac.draw() menu:draw() end

-- What a person would do, one thing a step.
local script = {
    function() input.press("enter") end, -- start
    function() input.release("enter") input.press("down") end,
    function() input.type("!ü") end, -- into the name
    function() input.press("backspace") end,
    function() input.press("pad_down") end,
    function() input.press("pad_right") end, -- volume 0.75
    function() input.move(400, 217) input.press("mouse1") end, -- on the slider, beyond its end
    function() input.release("mouse1") end,
    function() input.press("tab") end,
    function() input.press("space") end, -- shadows off
    function() input.move(100, 372) input.press("mouse1") end, -- third item that shows
    function() input.release("mouse1") input.press("pad_a") end, -- level
    function() input.press("escape") end,
}

function corsac.fixed(dt)
    ball:setRotation(0, math.sin(corsac.getTime()), 0, math.cos(corsac.getTime()))
    local act = bot and script[corsac.getStep()]
    if act then act() end
    corsac.metrics.set("volume", menu:get("volume"))
    corsac.metrics.set("level", menu:get("level"))
    corsac.metrics.set("shadows", menu:get("shadows") and 1 or 0)
    corsac.metrics.set("heard", #heard)
end

function corsac.quit()
    if bot then corsac.log("menu:", menu:get("player"), menu:getFocus(), table.concat(heard, " ")) end
end
