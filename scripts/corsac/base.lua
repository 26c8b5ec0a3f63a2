-- Lua's base library as scripts of the engine see it: the same results in every run, on every
-- machine, with the compiler on or off. `engine` holds the C half (state.c).
local engine = ...

local rawget, rawtype, select = rawget, type, select
local rawtostring, rawformat = tostring, string.format
local rawsetmetatable, rawgetmetatable = setmetatable, debug.getmetatable
local keysOf, find, gsub = engine.keys, string.find, string.gsub
local floor = math.floor

local function err(level, fmt, ...) error(rawformat(fmt, ...), level + 1) end

-- Walking tables -------------------------------------------------------------------------------

function pairs(t)
    local meta = rawgetmetatable(t)
    if meta and rawget(meta, "__pairs") then return meta.__pairs(t) end
    if rawtype(t) ~= "table" then err(2, "pairs: expected a table, got %s", engine.describe(t)) end
    local keys, n = keysOf(t)
    local i = 0
    if not keys then
        return function()
            while i < n do
                i = i + 1
                local v = rawget(t, i)
                if v ~= nil then return i, v end
            end
        end
    end
    return function()
        while i < n do
            i = i + 1
            local k = keys[i]
            local v = rawget(t, k)
            if v ~= nil then return k, v end
        end
    end
end

next = engine.next
table.foreach, table.foreachi, table.getn = nil, nil, nil

-- Texts without addresses ------------------------------------------------------------------------

local function printable(v)
    local kind = rawtype(v)
    if kind == "table" or kind == "function" or kind == "thread" or kind == "cdata" then
        local meta = rawgetmetatable(v)
        if kind ~= "table" or not meta or not rawget(meta, "__tostring") then
            return (gsub(rawtostring(v), ": *0x%x+$", ""))
        end
    end
    return rawtostring(v)
end
tostring = printable

local function plain(v)
    local kind = rawtype(v)
    if kind == "string" or kind == "number" then return v end
    if kind == "table" or kind == "function" or kind == "thread" or kind == "cdata" then
        return printable(v)
    end
    return v
end

local checked = {}
local function formatMany(fmt, ...)
    local list = { ... }
    local n = select("#", ...)
    for i = 1, n do list[i] = plain(list[i]) end
    return rawformat(fmt, unpack(list, 1, n))
end

function string.format(fmt, ...)
    if not checked[fmt] then
        if rawtype(fmt) == "string" and find(gsub(fmt, "%%%%", ""), "%%[%-+ #0-9.]*p") then
            err(2, "string.format: %%p would print an address, which differs from run to run")
        end
        if fmt ~= nil then checked[fmt] = true end
    end
    local n = select("#", ...)
    if n == 1 then
        local a = ...
        return rawformat(fmt, plain(a))
    elseif n == 2 then
        local a, b = ...
        return rawformat(fmt, plain(a), plain(b))
    elseif n == 3 then
        local a, b, c = ...
        return rawformat(fmt, plain(a), plain(b), plain(c))
    elseif n == 0 then
        return rawformat(fmt)
    end
    return formatMany(fmt, ...)
end

-- Random numbers: one stream for the simulation, one for what only shows it ----------------------

local reseed = engine.reseed

function math.random(a, b)
    local u = engine.random()
    if a == nil then return u end
    local low, high = 1, a
    if b ~= nil then low, high = a, b end
    if rawtype(low) ~= "number" or rawtype(high) ~= "number" then
        local wrong = rawtype(low) ~= "number" and low or high
        err(2, "math.random: expected numbers, got %s", engine.describe(wrong))
    end
    low, high = floor(low), floor(high)
    if low > high then err(2, "math.random: the interval %d..%d is empty", low, high) end
    return low + floor(u * (high - low + 1))
end

function math.randomseed(n)
    if rawtype(n) ~= "number" then
        err(2, "math.randomseed: expected a number, got %s", engine.describe(n))
    end
    reseed(n)
end

-- Clock, collector, metatables -------------------------------------------------------------------

local clock = { time = os.time, clock = os.clock, date = os.date }
local simulating = engine.simulating
os = {}
for _, name in ipairs { "time", "clock", "date" } do
    os[name] = function(...)
        if simulating() then
            err(2, "os.%s reads the wall clock, which would make every run different; "
                .. "the simulation's own time is corsac.getTime()", name)
        end
        return clock[name](...)
    end
end

local collect = collectgarbage
function collectgarbage(what, n)
    if what == "count" and simulating() then
        err(2, 'collectgarbage("count") differs from run to run; call it from corsac.update '
            .. "or read the metric counts.lua_kb")
    end
    local result = collect(what or "collect", n)
    return what == "count" and result or 0
end

function setmetatable(t, meta)
    if rawtype(meta) == "table" and (rawget(meta, "__mode") or rawget(meta, "__gc")) then
        err(2, "setmetatable: __mode and __gc depend on when the collector runs, which differs "
            .. "from run to run; remove entries yourself")
    end
    return rawsetmetatable(t, meta)
end

-- Code from text and files -----------------------------------------------------------------------

local rawload = load
function load(text, name, _, env)
    if rawtype(text) ~= "string" and rawtype(text) ~= "function" then
        err(2, "load: expected a string or a function, got %s", engine.describe(text))
    end
    return rawload(text, name or (rawtype(text) == "string" and text or "=load"), "t", env or _G)
end
loadstring = load

local builtin = {
    bit = bit, jit = jit, string = string, table = table, math = math,
    coroutine = coroutine, os = os,
}
local builtinLoaders = {
    ffi = true, ["table.new"] = true, ["table.clear"] = true, ["string.buffer"] = true,
}
local rawrequire = require
local loaded = {}
engine.loaded = loaded

-- "a.b" is a/b.lua or a/b/init.lua in the game's folder; what it returns is kept.
function require(name)
    if rawtype(name) ~= "string" then
        err(2, "require: expected a name, got %s", engine.describe(name))
    end
    if builtin[name] then return builtin[name] end
    if builtinLoaders[name] then return rawrequire(name) end
    local entry = loaded[name]
    if entry then
        if entry.loading then err(2, 'require: "%s" requires itself through other files', name) end
        return entry.value
    end
    entry = { loading = true }
    loaded[name] = entry
    local chunk, path = engine.findModule(name)
    if not chunk then
        loaded[name] = nil
        err(2, "require: %s", path)
    end
    entry.path = path
    local ok, value = pcall(chunk, name)
    if not ok then
        loaded[name] = nil
        error(value, 0)
    end
    entry.loading = nil
    entry.value = value == nil and true or value
    return entry.value
end

function dofile(path)
    local chunk, why = engine.loadFile(path)
    if not chunk then err(2, "dofile: %s", why) end
    return chunk()
end
function loadfile(path) return engine.loadFile(path) end

-- print goes to the log: stdout belongs to results.
function print(...)
    local list = { ... }
    for i = 1, select("#", ...) do list[i] = printable(list[i]) end
    engine.print(table.concat(list, "  "))
end

debug = { traceback = debug.traceback }
io, package, module, newproxy, gcinfo, getfenv, setfenv = nil, nil, nil, nil, nil, nil, nil
string.dump = nil
