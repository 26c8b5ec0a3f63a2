-- The game's end of modding: services and patched data. Mods reach `serve` only, with copies.
local engine = ...
local lua, serve = engine.lua, {}
engine.serve = serve

local services = {}
lua["corsac.mods.export"] = function(name, functions)
    for key, fn in pairs(functions) do
        if type(key) ~= "string" or type(fn) ~= "function" then
            error(('corsac.mods.export: "%s": expected name = function'):format(name), 2)
        end
    end
    services[name] = functions
end

function serve.call(path, ...)
    local name, key = path:match("^([^.]*)%.([^.]*)$")
    local service = name and services[name]
    if not service then
        error(('corsac.mod.call: no service "%s"%s'):format(path, engine.near(name or path, services)), 0)
    end
    local fn = service[key]
    if not fn then
        error(('corsac.mod.call: service "%s" has no "%s"%s'):format(
            name, key, engine.near(key, service)), 0)
    end
    return fn(...)
end

-- Data: mods patch before corsac.load; the game declares it there. Later mods win, and say so.
local data, patches = {}, {}

function serve.patch(mod, name, changes)
    local list = patches[name] or {}
    patches[name] = list
    list[#list + 1] = { mod = mod, changes = changes }
end

local function merge(target, changes, mod, path, by)
    for key, value in pairs(changes) do
        local at = path .. "." .. tostring(key)
        if type(value) == "table" and type(target[key]) == "table" then
            merge(target[key], value, mod, at, by)
        else
            if by[at] and target[key] ~= value then
                corsac.warn(("mods %s and %s both set %s; %s wins"):format(by[at], mod, at, mod))
            end
            target[key], by[at] = value, mod
        end
    end
end

lua["corsac.mods.data"] = function(name, table)
    local by = {}
    for _, patch in ipairs(patches[name] or {}) do merge(table, patch.changes, patch.mod, name, by) end
    data[name] = table
    return table
end

function serve.data(name) return data[name] end
