-- Containers whose order is defined: by insertion (Map, Queue) or by priority, then insertion (Heap).
local engine = ...
local lua = engine.lua

local function class(name, methods)
    local meta = { __metatable = name, __tostring = function() return name end }
    setmetatable(methods, {
        __index = function(_, key)
            error(name .. ' has no "' .. tostring(key) .. '"' .. engine.near(key, methods), 2)
        end,
    })
    meta.__index = methods
    meta.__newindex = function() error(name .. " holds no fields; use its methods", 2) end
    return meta
end

-- Map --------------------------------------------------------------------------------------------

local Map = {}
local mapState = {} -- map -> {place = key -> index, keys, values, n, count}
local mapMeta

function Map:set(key, value)
    local s = mapState[self]
    if key == nil then error("Map:set: the key is nil", 2) end
    local at = s.place[key]
    if value == nil then
        if at then
            s.place[key], s.keys[at], s.values[at] = nil, nil, nil
            s.count = s.count - 1
        end
        return
    end
    if not at then
        s.n = s.n + 1
        s.count = s.count + 1
        at = s.n
        s.place[key], s.keys[at] = at, key
    end
    s.values[at] = value
end

function Map:get(key)
    local s = mapState[self]
    local at = s.place[key]
    return at and s.values[at]
end

function Map:has(key) return mapState[self].place[key] ~= nil end

function Map:count() return mapState[self].count end

-- Removes what an earlier walk may still stand on only when no walk can: at the next walk.
local function compact(s)
    if s.n == s.count then return end
    local keys, values, n = {}, {}, 0
    for i = 1, s.n do
        if s.keys[i] ~= nil then
            n = n + 1
            keys[n], values[n], s.place[s.keys[i]] = s.keys[i], s.values[i], n
        end
    end
    s.keys, s.values, s.n = keys, values, n
end

-- for key, value in map:each() do: in order of insertion; entries may be set and removed on the way.
function Map:each()
    local s = mapState[self]
    if s.n > 2 * s.count + 8 then compact(s) end
    local keys, values, i, n = s.keys, s.values, 0, s.n
    return function()
        while i < n do
            i = i + 1
            local key = keys[i]
            if key ~= nil then return key, values[i] end
        end
    end
end

mapMeta = class("Map", Map)
mapMeta.__pairs = Map.each

-- Queue ------------------------------------------------------------------------------------------

local Queue = {}
local queueState = {}

function Queue:push(value)
    if value == nil then error("Queue:push: the value is nil", 2) end
    local s = queueState[self]
    s.last = s.last + 1
    s[s.last] = value
end

function Queue:pop()
    local s = queueState[self]
    if s.first > s.last then return nil end
    local value = s[s.first]
    s[s.first] = nil
    s.first = s.first + 1
    return value
end

function Queue:peek() return queueState[self][queueState[self].first] end

function Queue:count()
    local s = queueState[self]
    return s.last - s.first + 1
end

local queueMeta = class("Queue", Queue)

-- Heap -------------------------------------------------------------------------------------------

local Heap = {}
local heapState = {} -- arrays of priority, order of insertion, value

local function before(s, i, j)
    local a, b = s.priority[i], s.priority[j]
    return a < b or (a == b and s.order[i] < s.order[j])
end

local function swap(s, i, j)
    s.priority[i], s.priority[j] = s.priority[j], s.priority[i]
    s.order[i], s.order[j] = s.order[j], s.order[i]
    s.value[i], s.value[j] = s.value[j], s.value[i]
end

-- push(priority, value); pop() gives the value of the lowest priority, the oldest among equals.
function Heap:push(priority, value)
    if type(priority) ~= "number" or priority ~= priority or value == nil then
        error("Heap:push: expected a number and a value", 2)
    end
    local s = heapState[self]
    local i = s.n + 1
    s.n, s.serial = i, s.serial + 1
    s.priority[i], s.order[i], s.value[i] = priority, s.serial, value
    while i > 1 do
        local up = (i - i % 2) / 2
        if not before(s, i, up) then break end
        swap(s, i, up)
        i = up
    end
end

function Heap:pop()
    local s = heapState[self]
    local n = s.n
    if n == 0 then return nil end
    local value, priority = s.value[1], s.priority[1]
    swap(s, 1, n)
    s.priority[n], s.order[n], s.value[n] = nil, nil, nil
    s.n = n - 1
    local i = 1
    while true do
        local low, left = i, 2 * i
        if left < n and before(s, left, low) then low = left end
        if left + 1 < n and before(s, left + 1, low) then low = left + 1 end
        if low == i then break end
        swap(s, i, low)
        i = low
    end
    return value, priority
end

function Heap:count() return heapState[self].n end

local heapMeta = class("Heap", Heap)

-- The states hang on the objects by a hidden key, so that they go when the objects go.
local function hidden(store)
    local key = {}
    return setmetatable(store, {
        __index = function(_, object)
            local meta = engine.rawmeta(object)
            if meta ~= mapMeta and meta ~= queueMeta and meta ~= heapMeta then
                error("call methods with a colon: map:set(key, value)", 3)
            end
            return rawget(object, key)
        end,
        __newindex = function(_, object, state) rawset(object, key, state) end,
    })
end
hidden(mapState)
hidden(queueState)
hidden(heapState)

lua["corsac.newMap"] = function()
    local map = setmetatable({}, mapMeta)
    mapState[map] = { place = {}, keys = {}, values = {}, n = 0, count = 0 }
    return map
end

lua["corsac.newQueue"] = function()
    local queue = setmetatable({}, queueMeta)
    queueState[queue] = { first = 1, last = 0 }
    return queue
end

lua["corsac.newHeap"] = function()
    local heap = setmetatable({}, heapMeta)
    heapState[heap] = { priority = {}, order = {}, value = {}, n = 0, serial = 0 }
    return heap
end
