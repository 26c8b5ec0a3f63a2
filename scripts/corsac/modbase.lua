-- The base library of mods: what the guard left (engine/script/guard.c), with defined orders and
-- texts without addresses.
local engine = ...
local rawtype, rawtostring, rawformat = type, tostring, string.format
local gsub, find, floor, select = string.gsub, string.find, math.floor, select
local keysOf = engine.keys
local rawsetmetatable = setmetatable

function pairs(t)
    if rawtype(t) ~= "table" then
        error("pairs: expected a table, got " .. engine.describe(t), 2)
    end
    local keys, n = keysOf(t)
    local i = 0
    return function()
        while i < n do
            i = i + 1
            local k = i
            if keys then k = keys[i] end
            local v = t[k]
            if v ~= nil then return k, v end
        end
    end
end

next = engine.next

function tostring(v)
    local kind = rawtype(v)
    if kind == "table" or kind == "function" or kind == "thread" then
        local meta = engine.rawmeta(v)
        if kind ~= "table" or not meta or meta.__tostring == nil then return kind end
    end
    return rawtostring(v)
end
local tostring = tostring

function string.format(fmt, ...)
    if rawtype(fmt) == "string" and find(gsub(fmt, "%%%%", ""), "%%[%-+ #0-9.]*p") then
        error("string.format: %p would print an address", 2)
    end
    local list = { ... }
    local n = select("#", ...)
    for i = 1, n do
        local kind = rawtype(list[i])
        if kind == "table" or kind == "function" then list[i] = tostring(list[i]) end
    end
    return rawformat(fmt, unpack(list, 1, n))
end

function setmetatable(t, meta)
    if rawtype(meta) == "table" and (meta.__mode or meta.__gc) then
        error("setmetatable: __mode and __gc depend on when the collector runs", 2)
    end
    return rawsetmetatable(t, meta)
end

function math.random(a, b)
    local u = engine.random()
    if a == nil then return u end
    local low, high = 1, a
    if b ~= nil then low, high = a, b end
    low, high = floor(low), floor(high)
    if low > high then error("math.random: the interval is empty", 2) end
    return low + floor(u * (high - low + 1))
end
math.randomseed = nil

function print(...)
    local list = { ... }
    for i = 1, select("#", ...) do list[i] = tostring(list[i]) end
    corsac.log(table.concat(list, "  "))
end
