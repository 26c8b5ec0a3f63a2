-- corsac.ui: menus as columns of widgets, drawn with corsac.gfx and driven by corsac.event alone, so
-- that a recording drives them too. Nothing here depends on whether a frame is drawn.
local engine = ...
local lua = engine.lua
local floor, max, min = math.floor, math.max, math.min

local defaults = { -- a panel's theme changes any of these
    font = "sans", size = 19, row = 38, gap = 8, pad = 18, radius = 7,
    panel = { 0.07, 0.08, 0.11, 0.92 }, edge = { 0.3, 0.34, 0.42, 0.6 },
    widget = { 0.16, 0.18, 0.23, 1 }, hover = { 0.21, 0.25, 0.33, 1 },
    accent = { 0.98, 0.62, 0.22, 1 }, text = { 0.94, 0.95, 0.97, 1 }, dim = { 0.62, 0.66, 0.74, 1 },
}

local function fail(text, ...) error(engine.where() .. ("corsac.ui: " .. text):format(...), 0) end

-- known: name -> its type, "any" for values of every type.
local function checkFields(given, known, what)
    for key, value in pairs(given) do
        if type(key) == "string" and known[key] == nil then
            fail('%s has no "%s"%s', what, key, engine.near(key, known))
        end
        if type(key) == "string" and known[key] ~= "any" and type(value) ~= known[key] then
            fail("%s: %s: expected a %s, got %s", what, key, known[key], engine.describe(value))
        end
    end
end

local function call(fn, ...) if fn then fn(...) end end

-- Text of a field as a list of UTF-8 characters ---------------------------------------------------

local function characters(text)
    local list = {}
    for c in tostring(text):gmatch("[%z\1-\127\194-\244][\128-\191]*") do list[#list + 1] = c end
    return list
end

local function write(p, text, x, y, width, color, align)
    local t = p.theme
    corsac.gfx.text(text, { x = x, y = y, size = t.size, font = t.font, color = color, align = align or 0,
        width = width > 0 and align ~= nil and width or 0 })
end

local function middle(p, w) return w.y + floor((p.theme.row - p.theme.size) / 2) end

local function box(p, w, h, on)
    local t = p.theme
    corsac.gfx.roundRect(w.x, w.y, w.w, h, t.radius, (on or p.focused == w) and t.hover or t.widget)
    if p.focused == w then corsac.gfx.roundRect(w.x, w.y, w.w, h, t.radius, t.accent, 2) end
end

-- Kinds of widgets: fields they take, height, what input and drawing do ---------------------------

local common = { type = "string", name = "string", text = "any" }
local function fields(more)
    local all = {}
    for key, kind in pairs(common) do all[key] = kind end
    for key, kind in pairs(more) do all[key] = kind end
    return all
end

local kinds = {}

kinds.gap = {
    fields = fields { height = "number" },
    height = function(p, w) return w.height or p.theme.gap end,
    draw = function() end,
}

kinds.label = {
    fields = fields { align = "number" },
    height = function(p) return p.theme.row end,
    draw = function(p, w) write(p, w.text, w.x, middle(p, w), w.w, p.theme.dim, w.align or 0) end,
}

kinds.button = {
    fields = fields { press = "function" },
    focus = true,
    height = function(p) return p.theme.row end,
    activate = function(_, w) call(w.press) end,
    draw = function(p, w)
        box(p, w, p.theme.row, p.held == w)
        write(p, w.text, w.x, middle(p, w), w.w, p.theme.text, 0.5)
    end,
}

kinds.toggle = {
    fields = fields { value = "boolean", change = "function" },
    focus = true,
    start = function(w) w.value = w.value and true or false end,
    check = function(w, value)
        if type(value) ~= "boolean" then fail('"%s" is on or off: expected a boolean', w.name) end
        return value
    end,
    height = function(p) return p.theme.row end,
    activate = function(_, w)
        w.value = not w.value
        call(w.change, w.value)
    end,
    draw = function(p, w)
        local t = p.theme
        box(p, w, t.row, false)
        write(p, w.text, w.x + t.pad, middle(p, w), 0, t.text)
        local h = t.row - 18
        local x, y = w.x + w.w - t.pad - 2 * h, w.y + 9
        corsac.gfx.roundRect(x, y, 2 * h, h, h / 2, w.value and t.accent or t.edge)
        corsac.gfx.roundRect(x + (w.value and h or 0) + 3, y + 3, h - 6, h - 6, h / 2, t.text)
    end,
}

local function setSlider(w, value)
    value = max(w.min, min(w.max, value))
    if w.step > 0 then value = min(w.max, w.min + floor((value - w.min) / w.step + 0.5) * w.step) end
    if value ~= w.value then
        w.value = value
        call(w.change, value)
    end
end

kinds.slider = {
    fields = fields { min = "number", max = "number", step = "number", value = "number", change = "function",
        format = "string" },
    focus = true,
    start = function(w)
        w.min, w.max, w.step = w.min or 0, w.max or 1, w.step or 0
        if w.min >= w.max then fail('slider "%s": min %g is not below max %g', w.name, w.min, w.max) end
        local change = w.change
        w.change, w.value = nil, w.value or w.min
        setSlider(w, w.value)
        w.change = change
    end,
    check = function(w, value)
        if type(value) ~= "number" then fail('"%s": expected a number', w.name) end
        return max(w.min, min(w.max, value))
    end,
    height = function(p) return p.theme.row + 12 end,
    drag = function(p, w, x)
        local left = w.x + p.theme.pad
        setSlider(w, w.min + (w.max - w.min) * (x - left) / (w.w - 2 * p.theme.pad))
    end,
    side = function(_, w, way) setSlider(w, w.value + way * (w.step > 0 and w.step or (w.max - w.min) / 20)) end,
    draw = function(p, w)
        local t = p.theme
        box(p, w, t.row + 12, p.held == w)
        local left, wide = w.x + t.pad, w.w - 2 * t.pad
        local y, share = w.y + t.row - 3, (w.value - w.min) / (w.max - w.min)
        write(p, w.text, left, w.y + 7, 0, t.text)
        write(p, (w.format or "%g"):format(w.value), left, w.y + 7, wide, t.dim, 1)
        corsac.gfx.roundRect(left, y, wide, 6, 3, t.edge)
        corsac.gfx.roundRect(left, y, max(6, wide * share), 6, 3, t.accent)
        corsac.gfx.roundRect(left + wide * share - 8, y - 5, 16, 16, 8, t.text)
    end,
}

local function lineHeight(p) return p.theme.size + 10 end

local function select(w, index)
    index = max(1, min(#w.items, index))
    w.top = max(min(w.top, index), index - w.rows + 1)
    if index ~= w.value then
        w.value = index
        call(w.change, index, w.items[index])
    end
end

kinds.list = {
    fields = fields { items = "table", rows = "number", value = "number", change = "function", press = "function" },
    focus = true,
    start = function(w)
        if type(w.items) ~= "table" or #w.items == 0 then
            fail('list "%s" needs items, a list of texts', w.name)
        end
        w.rows = min(w.rows or 5, #w.items)
        w.top, w.value = 1, max(1, min(#w.items, w.value or 1))
        w.top = max(1, w.value - w.rows + 1)
    end,
    check = function(w, value)
        if type(value) ~= "number" or not w.items[value] then
            fail('"%s": expected a place in its items, 1 to %d', w.name, #w.items)
        end
        return value
    end,
    height = function(p, w) return w.rows * lineHeight(p) + 12 end,
    press = function(p, w, _, y)
        local row = floor((y - w.y - 6) / lineHeight(p))
        if row >= 0 and row < w.rows then select(w, w.top + row) end
    end,
    upDown = function(_, w, way)
        if not w.items[w.value + way] then return false end
        select(w, w.value + way)
        return true
    end,
    scroll = function(_, w, way) w.top = max(1, min(#w.items - w.rows + 1, w.top - way)) end,
    activate = function(_, w) call(w.press, w.value, w.items[w.value]) end,
    draw = function(p, w)
        local t, h = p.theme, lineHeight(p)
        box(p, w, w.rows * h + 12, false)
        corsac.gfx.pushClip(w.x, w.y, w.w, w.rows * h + 12)
        for row = 0, w.rows - 1 do
            local i, y = w.top + row, w.y + 6 + row * h
            if i == w.value then corsac.gfx.roundRect(w.x + 6, y, w.w - 12, h, 5, t.edge) end
            write(p, tostring(w.items[i]), w.x + t.pad, y + 5, 0, i == w.value and t.text or t.dim)
        end
        if #w.items > w.rows then
            local way, size = w.rows * h, w.rows / #w.items
            corsac.gfx.roundRect(w.x + w.w - 8, w.y + 6 + way * (w.top - 1) / #w.items, 4, way * size, 2, t.dim)
        end
        corsac.gfx.popClip()
    end,
}

local function before(w, caret) return table.concat(w.letters, "", 1, caret) end

local function edited(w)
    w.value = table.concat(w.letters)
    call(w.change, w.value)
end

kinds.field = {
    fields = fields { value = "any", max = "number", change = "function", enter = "function" },
    focus = true,
    start = function(w)
        w.max, w.letters = w.max or 32, characters(w.value or "")
        w.caret, w.value = #w.letters, table.concat(w.letters)
    end,
    check = function(w, value)
        w.letters = characters(value)
        w.caret = #w.letters
        return table.concat(w.letters)
    end,
    height = function(p) return p.theme.row end,
    press = function(p, w, x)
        local t, left, best = p.theme, w.valueX(p), 0
        for i = 1, #w.letters do
            local wide = corsac.gfx.measure(before(w, i), { size = t.size, font = t.font })
            local last = corsac.gfx.measure(before(w, i - 1), { size = t.size, font = t.font })
            if left + (wide + last) / 2 <= x then best = i end
        end
        w.caret = best
    end,
    side = function(_, w, way) w.caret = max(0, min(#w.letters, w.caret + way)) end,
    typed = function(_, w, text)
        for _, letter in ipairs(characters(text)) do
            if #w.letters >= w.max then break end
            w.caret = w.caret + 1
            table.insert(w.letters, w.caret, letter)
        end
        edited(w)
    end,
    key = function(_, w, key)
        if key == "backspace" and w.caret > 0 then
            table.remove(w.letters, w.caret)
            w.caret = w.caret - 1
            edited(w)
        elseif key == "delete" and w.caret < #w.letters then
            table.remove(w.letters, w.caret + 1)
            edited(w)
        elseif key == "home" then
            w.caret = 0
        elseif key == "end" then
            w.caret = #w.letters
        else
            return key == "space" -- it comes as text too
        end
        return true
    end,
    activate = function(_, w) call(w.enter, w.value) end,
    draw = function(p, w)
        local t = p.theme
        box(p, w, t.row, false)
        write(p, w.text, w.x + t.pad, middle(p, w), 0, t.dim)
        local x = w.valueX(p)
        corsac.gfx.pushClip(x - 2, w.y, w.x + w.w - t.pad - x + 4, t.row)
        write(p, w.value, x, middle(p, w), 0, t.text)
        if p.focused == w then
            local caret = corsac.gfx.measure(before(w, w.caret), { size = t.size, font = t.font })
            corsac.gfx.rect(x + floor(caret), w.y + 8, 2, t.row - 16, t.accent)
        end
        corsac.gfx.popClip()
    end,
}

-- Panels -----------------------------------------------------------------------------------------

local Panel = {}
local state = {} -- panel -> its record; never walked
local panelMeta = {
    __metatable = "Panel", __tostring = function() return "Panel" end,
    __newindex = function() error("a Panel holds no fields; panel:set(name, value) sets a widget", 2) end,
}
panelMeta.__index = setmetatable(Panel, {
    __index = function(_, key)
        error('Panel has no "' .. tostring(key) .. '"' .. engine.near(key, Panel), 2)
    end,
})

-- Places of the widgets for the size of the frame now.
local function arrange(p)
    local width, height = corsac.gfx.getSize()
    local t, tall = p.theme, p.theme.pad * 2 + (p.title and p.theme.row + p.theme.gap or 0)
    for i, w in ipairs(p.widgets) do
        tall = tall + w.kind.height(p, w) + (i > 1 and t.gap or 0)
    end
    p.h = p.height or tall
    p.left = p.x or floor((width - p.w) / 2)
    p.top = p.y or floor((height - p.h) / 2)
    local y = p.top + t.pad + (p.title and t.row + t.gap or 0)
    for _, w in ipairs(p.widgets) do
        w.x, w.y, w.w, w.h = p.left + t.pad, y, p.w - 2 * t.pad, w.kind.height(p, w)
        y = y + w.h + t.gap
    end
end

local function at(p, x, y)
    for _, w in ipairs(p.widgets) do
        if w.kind.focus and x >= w.x and x < w.x + w.w and y >= w.y and y < w.y + w.h then return w end
    end
    return nil
end

local function moveFocus(p, way)
    local n, place = #p.widgets, 0
    for i, w in ipairs(p.widgets) do
        if w == p.focused then place = i end
    end
    if place == 0 and way < 0 then place = n + 1 end
    for _ = 1, n do
        place = (place + way - 1) % n + 1
        if p.widgets[place].kind.focus then
            p.focused = p.widgets[place]
            return
        end
    end
end

local function onPointer(p, name, button, pressed, x, y)
    if name == "move" then
        x, y = button, pressed
        if p.held then
            call(p.held.kind.drag, p, p.held, x, y)
        else
            p.focused = at(p, x, y) or p.focused
        end
        p.px, p.py = x, y
        return p.held ~= nil
    end
    if button ~= "mouse1" then return false end
    local w, held = at(p, x, y), p.held
    if pressed == 1 then
        p.held, p.focused = w, w or p.focused
        if w then
            call(w.kind.press, p, w, x, y)
            call(w.kind.drag, p, w, x, y)
        end
    else
        p.held = nil
        if held and held == w and (held.kind == kinds.button or held.kind == kinds.toggle) then
            w.kind.activate(p, w)
        end
    end
    return w ~= nil or held ~= nil
end

local directions = {
    up = "up", down = "down", left = "left", right = "right", enter = "enter", kpenter = "enter",
    space = "enter", escape = "cancel", tab = "tab", pad_up = "up", pad_down = "down", pad_left = "left",
    pad_right = "right", pad_a = "enter", pad_b = "cancel",
}

local function onKey(p, key)
    local w, to = p.focused, directions[key]
    if w and w.kind.key and w.kind.key(p, w, key) then return true end
    if to == "tab" then
        moveFocus(p, p.shift and -1 or 1)
    elseif to == "up" or to == "down" then
        local way = to == "up" and -1 or 1
        if not (w and w.kind.upDown and w.kind.upDown(p, w, way)) then moveFocus(p, way) end
    elseif to == "left" or to == "right" then
        if not (w and w.kind.side) then return false end
        w.kind.side(p, w, to == "left" and -1 or 1)
    elseif to == "enter" then
        if not w then return false end
        call(w.kind.activate, p, w)
    elseif to == "cancel" and p.cancel then
        p.cancel()
    else
        return false
    end
    return true
end

-- What corsac.event heard; true when the menu took it.
function Panel:event(name, a, b, c, d)
    local p = state[self]
    if not p.shown then return false end
    arrange(p)
    if name == "move" or name == "mouse" then return onPointer(p, name, a, b, c, d) end
    if name == "key" and (a == "lshift" or a == "rshift") then p.shift = b ~= 0 end
    if name == "key" or name == "button" then return b ~= 0 and onKey(p, a) end
    local w = p.focused
    if name == "text" and w and w.kind.typed then
        w.kind.typed(p, w, a)
        return true
    end
    w = name == "scroll" and at(p, p.px, p.py)
    if w and w.kind.scroll then
        w.kind.scroll(p, w, b > 0 and 1 or -1)
        return true
    end
    return false
end

function Panel:draw()
    local p = state[self]
    if not p.shown then return end
    arrange(p)
    local t = p.theme
    corsac.gfx.roundRect(p.left, p.top, p.w, p.h, t.radius * 2, t.panel)
    corsac.gfx.roundRect(p.left, p.top, p.w, p.h, t.radius * 2, t.edge, 1)
    if p.title then
        corsac.gfx.text(p.title, { x = p.left + t.pad, y = p.top + t.pad, size = t.size + 9, font = t.font,
            color = t.text })
    end
    for _, w in ipairs(p.widgets) do w.kind.draw(p, w) end
end

local function find(self, name)
    local p = state[self]
    local w = p.byName[name]
    if not w then fail('no widget "%s"%s', tostring(name), engine.near(tostring(name), p.byName)) end
    return w, p
end

function Panel:get(name) return (find(self, name)).value end

-- Changes a widget's value without calling its `change`; a label's or button's text.
function Panel:set(name, value)
    local w = find(self, name)
    if w.kind.check then w.value = w.kind.check(w, value) else w.text = tostring(value) end
end

function Panel:focus(name)
    local w, p = find(self, name)
    if not w.kind.focus then fail('"%s" is a %s and takes no focus', name, w.type) end
    p.focused = w
end

function Panel:getFocus()
    local w = state[self].focused
    return w and w.name
end

function Panel:show(on) state[self].shown, state[self].held = on and true or false, nil end

function Panel:isShown() return state[self].shown end

local panelFields = { x = "number", y = "number", width = "number", height = "number", title = "string",
    theme = "table", shown = "boolean", cancel = "function" }
local themeFields = {}
for key, value in pairs(defaults) do themeFields[key] = type(value) end

local function newWidget(given, number)
    if type(given) ~= "table" then fail("widget %d: expected a table", number) end
    local kind = kinds[given.type]
    if not kind then
        fail('widget %d: no type "%s"%s', number, tostring(given.type), engine.near(tostring(given.type), kinds))
    end
    checkFields(given, kind.fields, ("widget %d (%s)"):format(number, given.type))
    local w = { kind = kind }
    for key, value in pairs(given) do w[key] = value end
    w.text = tostring(w.text or "")
    w.name = w.name or ("#" .. number)
    if kind.start then kind.start(w) end
    w.valueX = function(p) -- of a field: after its text
        local t = p.theme
        local wide = w.text ~= "" and corsac.gfx.measure(w.text, { size = t.size, font = t.font }) + t.pad or 0
        return floor(w.x + t.pad + wide)
    end
    return w
end

lua["corsac.ui.newPanel"] = function(options)
    checkFields(options, panelFields, "a panel")
    checkFields(options.theme or {}, themeFields, "a theme")
    local p = { theme = {}, widgets = {}, byName = {}, shown = options.shown ~= false, x = options.x, y = options.y,
        w = options.width or 360, height = options.height, title = options.title, cancel = options.cancel,
        px = -1, py = -1 }
    for key, value in pairs(defaults) do p.theme[key] = (options.theme or {})[key] or value end
    for i, given in ipairs(options) do
        local w = newWidget(given, i)
        if p.byName[w.name] then fail('two widgets are named "%s"', w.name) end
        p.widgets[i], p.byName[w.name] = w, w
        p.focused = p.focused or (w.kind.focus and w) or nil
    end
    local panel = setmetatable({}, panelMeta)
    state[panel] = p
    return panel
end
