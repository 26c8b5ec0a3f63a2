-- Methods of plain numbers as compiled traces like them: one call through FFI, no Lua stack. When
-- anything is amiss the checked method runs instead and words the error.
local engine = ...
local ffi, fast = engine.ffi, engine.native

-- LuaJIT may move a load from memory behind a later call (its assembler fuses loads into operands and
-- looks for stores only), so every call is followed by a store: what was read before it stays read.
-- PARAMS and so on are filled in for each count of arguments and returns.
local template = [[
local cast, object, call, self_, fn, kind, v, slow, type = ...
return function(self, PARAMS extra)
    if type(self) == "userdata" and extra == nil CHECKS then
        local o = cast(object, self)
        if o.type == kind then
            STORES
            if call(self_, fn, kind, o.index, o.generation, v) then
                LOADS
                v[8] = 0
                return VALUES
            end
        end
    end
    if extra ~= nil then return slow(self, PARAMS extra) end
    return slow(self PASS)
end]]

local function list(n, pattern, separator)
    local parts = {}
    for i = 1, n do parts[i] = (pattern:gsub("#", i):gsub("@", i - 1)) end
    return table.concat(parts, separator or "")
end

local v = ffi.new("double[9]")
local object = ffi.typeof("const corsac_object *")
for _, m in ipairs(engine.fastMethods()) do
    local text = template:gsub("%u%u%u%u%u+", {
        PARAMS = list(m.args, "a#, "), PASS = list(m.args, ", a#"),
        CHECKS = list(m.args, ' and type(a#) == "number" and a# - a# == 0'),
        STORES = list(m.args, "v[@] = a# "), VALUES = list(m.returns, "r#", ", "),
        LOADS = list(m.returns, "local r# = v[@] "),
    }):gsub("PASS", list(m.args, ", a#"))
    local make = assert(loadstring(text, "=corsac/fast.lua:" .. m.name))
    local slow = m.methods[m.name]
    m.methods[m.name] = make(ffi.cast, object, fast.numbers, fast.self,
        ffi.cast("const void *", m.fn), ffi.cast("const void *", m.type), v, slow, type)
end
