-- Named events: listeners hear them in the order in which they were added.
local engine = ...
local lua = engine.lua

local listeners = {} -- name -> array of {fn, gone}

lua["corsac.on"] = function(name, fn)
    local list = listeners[name]
    if not list then
        list = {}
        listeners[name] = list
    end
    list[#list + 1] = { fn = fn, top = engine.atTop and engine.atTop() }
end

-- Listeners that the files' own code added: taken out before it runs anew; given back when it fails.
function engine.setTopListeners(former)
    local removed = {}
    for name, list in pairs(listeners) do
        local kept, count = {}, 0
        for i = 1, #list do
            if not list[i].top then
                count = count + 1
                kept[count] = list[i]
            end
        end
        removed[name], listeners[name] = list, count > 0 and kept or nil
    end
    for name, list in pairs(former or {}) do listeners[name] = list end
    return removed
end

lua["corsac.off"] = function(name, fn)
    local list = listeners[name] or {}
    for i = 1, #list do
        if list[i].fn == fn and not list[i].gone then
            list[i].gone = true
            return true
        end
    end
    return false
end

local depth = 0

local function sweep(name, list)
    local kept = {}
    for i = 1, #list do
        if not list[i].gone then kept[#kept + 1] = list[i] end
    end
    listeners[name] = #kept > 0 and kept or nil
end

-- A listener that returns false is not called again.
local function emit(name, ...)
    local list = listeners[name]
    if not list then return 0 end
    if depth == 32 then error('corsac.emit("' .. name .. '"): events that emit events, 32 deep', 2) end
    depth = depth + 1
    local known, heard, gone = #list, 0, false
    local ok, why = true, nil
    for i = 1, known do
        local entry = list[i]
        if not entry.gone then
            heard = heard + 1
            local result
            ok, result = pcall(entry.fn, ...)
            if not ok then
                why = result
                break
            end
            if result == false then entry.gone = true end
        end
        gone = gone or entry.gone
    end
    depth = depth - 1
    if gone and depth == 0 then sweep(name, list) end
    if not ok then error(why, 0) end
    return heard
end

-- Mods hear plain data only, so they are asked only when there are any.
lua["corsac.emit"] = function(name, ...)
    if not engine.hasMods or not engine.hasMods() then return emit(name, ...) end
    engine.modEvent(true, name, ...)
    local heard = emit(name, ...)
    engine.modEvent(false, name, ...)
    return heard
end
