-- Saved data: {version = n, data = ...} in one JSON file a name; and tables that survive reloads.
local engine = ...
local lua = engine.lua

lua["corsac.save.write"] = function(name, data, version)
    engine.saveWrite(name, { version = version or 1, data = data })
end

lua["corsac.save.read"] = function(name, options)
    local file = engine.saveRead(name)
    if file == nil then return nil end
    local version = options and options.version or 1
    if type(file) ~= "table" or type(file.version) ~= "number" or type(file.data) ~= "table" then
        error(('corsac.save.read: "%s" was not written by corsac.save.write'):format(name), 2)
    end
    if file.version == version then return file.data end
    local migrate = options and options.migrate
    if file.version > version or not migrate then
        error(('corsac.save.read: "%s" has version %d, this game reads version %d%s'):format(
            name, file.version, version,
            file.version < version and "; give migrate = function(data, version)" or ""), 2)
    end
    local data = migrate(file.data, file.version)
    if type(data) ~= "table" then
        error(('corsac.save.read: migrate of "%s" gave %s, expected a table'):format(
            name, engine.describe(data)), 2)
    end
    return data
end

local kept = {}
lua["corsac.persist"] = function(name, default)
    if kept[name] == nil then kept[name] = default end
    return kept[name]
end
engine.kept = kept

-- After a load of the scene: the game's tables stay the same tables.
function engine.restoreKept(saved, file)
    for name, contents in pairs(saved or {}) do
        local mine = kept[name]
        if mine == nil then
            kept[name] = contents
        else
            for key in pairs(mine) do mine[key] = nil end
            for key, value in pairs(contents) do mine[key] = value end
        end
    end
    corsac.emit("loaded", (file:gsub("%.%w+$", "")))
end
