-- corsac.phys.columns(): the bodies' columns as arrays.
local engine = ...
local ffi, fast = engine.ffi, engine.native

local view = ffi.new("corsac_columns")
local columns = {}
local fence = ffi.new("double[1]") -- a store after each call: see fast.lua
local object = ffi.typeof("const corsac_object *")

local bodyType = ffi.cast("const void *", engine.bodyType)

local function row(body)
    local o = type(body) == "userdata" and ffi.cast(object, body)
    if not o or o.type ~= bodyType then
        error("columns: row(body) expects a Body, got " .. engine.describe(body), 2)
    end
    local r = fast.row(fast.self, o.index, o.generation)
    fence[0] = 0
    if r == 0xffffffff then error("columns: this body was destroyed", 2) end
    return r
end

local function touch(r)
    local good = fast.touch(fast.self, r)
    fence[0] = 0
    if not good then
        error(("columns: touch(%s): the row must be a moving body's, its velocities finite, "
            .. "and the callback one that may change the simulation"):format(tostring(r)), 2)
    end
end

local plain = { row = row, handle = engine.bodyAt, touch = touch }
ffi.metatype("corsac_columns", { __index = plain })

local writable = { vx = true, vy = true, vz = true, wx = true, wy = true, wz = true }
local names = {
    "px", "py", "pz", "qx", "qy", "qz", "qw", "vx", "vy", "vz", "wx", "wy", "wz",
}

-- The same columns behind a check of every index: slow, for finding mistakes.
local function checkedView()
    local n = view.n
    local result = { n = n, row = row, handle = engine.bodyAt, touch = touch }
    local function check(name, i)
        if type(i) ~= "number" or i < 0 or i >= n or i % 1 ~= 0 then
            error(("columns: %s[%s]: rows are whole numbers from 0 to %d"):format(
                name, tostring(i), n - 1), 3)
        end
        if engine.callbackCount() ~= result.callback then
            error("columns: this view is of an earlier callback; call columns() again", 3)
        end
    end
    result.callback = engine.callbackCount()
    for _, name in ipairs(names) do
        local pointer = view[name]
        result[name] = setmetatable({}, {
            __index = function(_, i)
                check(name, i)
                return pointer[i]
            end,
            __newindex = function(_, i, x)
                check(name, i)
                if not writable[name] then
                    error("columns: " .. name .. " is read-only; use Body:setPosition", 2)
                end
                pointer[i] = x
            end,
        })
    end
    return result
end

function columns.get(options)
    fast.columns(fast.self, view)
    fence[0] = 0
    if options and options.checked then return checkedView() end
    return view
end

engine.lua["corsac.phys.columns"] = columns.get
