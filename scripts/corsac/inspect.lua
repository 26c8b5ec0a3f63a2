-- corsac.inspect(value): a table as text that can be read, and mostly be pasted back.
local engine = ...

local DEPTH, ITEMS = 6, 100

local function key(k)
    if type(k) == "string" and k:match("^[%a_][%w_]*$") then return k end
    return "[" .. (type(k) == "string" and ("%q"):format(k) or tostring(k)) .. "]"
end

local function orderedKeys(t)
    local keys, n = {}, 0
    local ok = pcall(function()
        for k in pairs(t) do
            n = n + 1
            keys[n] = k
        end
    end)
    return ok and keys
end

local function write(value, indent, seen, out)
    if type(value) == "string" then
        out[#out + 1] = ("%q"):format(value)
    elseif type(value) ~= "table" or engine.rawmeta(value) then
        out[#out + 1] = tostring(value)
    elseif seen[value] then
        out[#out + 1] = "(the table above)"
    elseif #indent >= 4 * DEPTH then
        out[#out + 1] = "{...}"
    else
        seen[value] = true
        local keys = orderedKeys(value)
        if not keys then
            out[#out + 1] = "{ (tables as keys) }"
        elseif #keys == 0 then
            out[#out + 1] = "{}"
        else
            local inner = indent .. "    "
            out[#out + 1] = "{\n"
            for i = 1, math.min(#keys, ITEMS) do
                local k = keys[i]
                out[#out + 1] = inner .. (k == i and "" or key(k) .. " = ")
                write(value[k], inner, seen, out)
                out[#out + 1] = ",\n"
            end
            if #keys > ITEMS then out[#out + 1] = inner .. "... " .. #keys - ITEMS .. " more\n" end
            out[#out + 1] = indent .. "}"
        end
        seen[value] = nil
    end
end

engine.lua["corsac.inspect"] = function(value)
    local out = {}
    write(value, "", {}, out)
    return table.concat(out)
end
