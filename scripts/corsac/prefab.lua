-- Prefabs: tables of options for corsac.scene.spawn that are kept, varied and nested.
local engine = ...
local lua = engine.lua

local function isList(t) return #t > 0 end

-- Tables of named fields are merged, everything else is replaced.
local function merge(base, over)
    if type(base) ~= "table" or type(over) ~= "table" or isList(base) or isList(over) then
        return over
    end
    local result = {}
    for k, v in pairs(base) do result[k] = v end
    for k, v in pairs(over) do result[k] = merge(base[k], v) end
    return result
end

local function copy(t)
    if type(t) ~= "table" then return t end
    local result = {}
    for k, v in pairs(t) do result[k] = copy(v) end
    return result
end

local function spawn(given)
    local children = given.children
    local plain = given
    if children then
        plain = {}
        for k, v in pairs(given) do
            if k ~= "children" then plain[k] = v end
        end
    end
    local entity = corsac.scene.spawn(plain)
    for _, child in ipairs(children or {}) do spawn(merge(child, { parent = entity })) end
    return entity
end

local options = {} -- hidden key of a prefab's table
local Prefab = { __metatable = "Prefab", __tostring = function() return "Prefab" end }
Prefab.__index = {
    spawn = function(self, over) return spawn(merge(rawget(self, options), over or {})) end,
    with = function(self, over)
        return lua["corsac.scene.newPrefab"](merge(rawget(self, options), over))
    end,
}
setmetatable(Prefab.__index, {
    __index = function(_, key)
        error('Prefab has no "' .. tostring(key) .. '"' .. engine.near(key, Prefab.__index), 2)
    end,
})
Prefab.__newindex = function() error("a Prefab is fixed; make another with prefab:with{...}", 2) end

lua["corsac.scene.newPrefab"] = function(given)
    return setmetatable({ [options] = copy(given) }, Prefab)
end
