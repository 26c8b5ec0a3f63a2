-- args: --steps 90
-- Timers, tweens, coroutines, events, containers, prefabs and JSON, each at the step it should be.
local log = {}
local function note(text) log[#log + 1] = corsac.getStep() .. " " .. text end

local box = { x = 0, y = 10 }
local heard = 0

function corsac.load()
    corsac.after(0.5, function() note("after") end)
    corsac.every(0.25, function() note("every") end, 2)
    local never = corsac.after(0.1, function() error("was cancelled") end)
    assert(corsac.cancel(never) and not corsac.cancel(never))
    corsac.tween{ length = 0.2, target = box, goals = { x = 6, y = 4 }, ease = "linear",
        done = function() note("tween " .. box.x .. " " .. box.y) end }
    corsac.spawn(function(a, b)
        note("spawn " .. a .. b)
        corsac.wait(1 / 60)
        note("waited one")
        corsac.wait(0.1)
        note("waited six")
        note("heard " .. corsac.waitFor("bell"))
    end, "a", "b")
    corsac.on("bell", function(name) heard = heard + 1 end)
    corsac.on("bell", function() heard = heard + 10 return false end)
end

function corsac.fixed()
    if corsac.getStep() == 20 then assert(corsac.emit("bell", "ding") == 3) end
    if corsac.getStep() == 40 then assert(corsac.emit("bell", "dong") == 1) end
end

local function sequence(each)
    local t = {}
    for k, v in each do t[#t + 1] = tostring(k) .. "=" .. tostring(v) end
    return table.concat(t, " ")
end

local function containers()
    local map = corsac.newMap()
    local key = {}
    map:set("b", 1)
    map:set("a", 2)
    map:set(3, 3)
    map:set(key, 4)
    assert(sequence(map:each()) == "b=1 a=2 3=3 table=4", sequence(map:each()))
    map:set("b", nil)
    map:set("a", 5)
    assert(sequence(pairs(map)) == "a=5 3=3 table=4" and map:count() == 3 and map:get(key) == 4)
    for k in map:each() do map:set(k, nil) end
    assert(map:count() == 0 and not map:has("a"))
    for i = 1, 100 do map:set(i, i) map:set(i - 3, nil) end
    assert(sequence(map:each()) == "98=98 99=99 100=100")
    local queue = corsac.newQueue()
    for i = 1, 5 do queue:push(i) end
    assert(queue:pop() == 1 and queue:peek() == 2 and queue:count() == 4)
    local heap, out = corsac.newHeap(), {}
    for i = 1, 200 do heap:push((i * 37) % 10, i) end
    local last, lastOrder = -1, 0
    while heap:count() > 0 do
        local value, priority = heap:pop()
        assert(priority > last or (priority == last and value > lastOrder))
        last, lastOrder = priority, value
        out[#out + 1] = value
    end
    assert(#out == 200)
    local ok, why = pcall(function() return map.gett end)
    assert(not ok and why:find('Map has no "gett"; did you mean "get"?', 1, true), why)
end

local function texts()
    local data = { name = "fox", list = { 1, 2.5, true }, inner = { a = "x\n\"y\"" } }
    local text = corsac.json.encode(data)
    local back = corsac.json.decode(text)
    assert(corsac.json.encode(back) == text and back.list[2] == 2.5 and back.inner.a == data.inner.a)
    local ok, why = pcall(corsac.json.decode, '{"a": [1, 2')
    assert(not ok and why:find("not valid JSON", 1, true), why)
end

local function prefabs()
    local crate = corsac.scene.newPrefab{
        mesh = "box", body = { shape = "box", size = { 1, 1, 1 }, density = 500 },
        children = { { mesh = "sphere", position = { 0, 1, 0 } } },
    }
    local heavy = crate:with{ body = { density = 2000 } }
    local before = corsac.scene.getCount()
    local a = crate:spawn{ position = { 30, 0, 0 } }
    local b = heavy:spawn{ position = { 33, 0, 0 }, name = "heavy" }
    assert(corsac.scene.getCount() == before + 4)
    assert(math.abs(a:getBody():getMass() - 500) < 0.01)
    assert(math.abs(b:getBody():getMass() - 2000) < 0.1 and b:getName() == "heavy")
end

function corsac.quit()
    local want = { "0 spawn ab", "0 waited one", "6 waited six", "11 tween 6 4", "14 every",
        "21 heard ding", "29 after", "29 every" }
    for i = 1, math.max(#want, #log) do
        assert(want[i] == log[i], ("line %d: wanted %s, have %s"):format(i, want[i], log[i]))
    end
    assert(heard == 12, heard)
end

local load = corsac.load
function corsac.load()
    load()
    containers()
    texts()
    prefabs()
end

local quit = corsac.quit
function corsac.quit()
    quit()
    local t = { 1, "a\nb", x = { y = {} }, ["odd key"] = true }
    t.self = t
    assert(corsac.inspect(t) == [[
{
    1,
    "a\
b",
    ["odd key"] = true,
    self = (the table above),
    x = {
        y = {},
    },
}]], corsac.inspect(t))
end
