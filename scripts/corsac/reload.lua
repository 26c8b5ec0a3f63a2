-- Runs the game's files anew and keeps the old code when one of them fails.
local engine = ...
local names = { "load", "fixed", "update", "draw", "event", "quit", "conf", "reload" }

function engine.reload(path)
    local chunk, why = engine.loadFile(path)
    if not chunk then return false, why end
    local callbacks, modules = {}, {}
    for _, name in ipairs(names) do
        callbacks[name] = rawget(corsac, name)
        rawset(corsac, name, nil)
    end
    for name, entry in pairs(engine.loaded) do
        modules[name] = entry
        engine.loaded[name] = nil
    end
    local listeners = engine.setTopListeners()
    local ok, reason = xpcall(chunk, debug.traceback)
    if ok then return true end
    for _, name in ipairs(names) do rawset(corsac, name, callbacks[name]) end
    for name in pairs(engine.loaded) do engine.loaded[name] = nil end
    for name, entry in pairs(modules) do engine.loaded[name] = entry end
    engine.setTopListeners(listeners)
    return false, reason
end
