-- Timers, tweens and coroutines. They live in the step: all run before corsac.fixed, in the order
-- in which they were started, and their times are whole steps, so every run sees the same.
local engine = ...
local lua = engine.lua
local ceil, max, min = math.ceil, math.max, math.min
local resume, create, status = coroutine.resume, coroutine.create, coroutine.status

local tasks, count = {}, 0 -- in order of start; cancelled ones leave a gap until the next tick
local step = 0

local Task = {
    __index = function(_, name)
        error('a task has no "' .. tostring(name) .. '"; corsac.cancel(task) ends it', 2)
    end,
    __newindex = function() error("a task holds no fields of yours", 2) end,
    __tostring = function() return "Task" end,
    __metatable = "Task",
}
local state = {} -- task -> its record; never walked

local function steps(seconds) return max(1, ceil(seconds / engine.dt() - 1e-9)) end

local function start(record)
    local task = setmetatable({}, Task)
    state[task] = record
    record.task = task
    count = count + 1
    tasks[count] = record
    engine.wake()
    return task
end

local function finish(record)
    record.done = true
    state[record.task] = nil
end

lua["corsac.after"] = function(seconds, fn)
    return start { due = step + steps(seconds), run = fn, left = 1, every = 0 }
end

lua["corsac.every"] = function(seconds, fn, times)
    local every = steps(seconds)
    return start { due = step + every, run = fn, left = times or math.huge, every = every }
end

lua["corsac.cancel"] = function(task)
    local record = state[task]
    if record then finish(record) end
    return record ~= nil
end

-- Tweens -----------------------------------------------------------------------------------------

local ease = {
    linear = function(t) return t end,
    smooth = function(t) return t * t * (3 - 2 * t) end,
    ["in"] = function(t) return t * t end,
    out = function(t) return t * (2 - t) end,
    bounce = function(t)
        local n, d = 7.5625, 2.75 -- four parabolas (Penner 2001)
        if t < 1 / d then return n * t * t end
        if t < 2 / d then t = t - 1.5 / d return n * t * t + 0.75 end
        if t < 2.5 / d then t = t - 2.25 / d return n * t * t + 0.9375 end
        t = t - 2.625 / d
        return n * t * t + 0.984375
    end,
}

lua["corsac.tween"] = function(options)
    local target, goals = options.target, options.goals
    local names, first, last = {}, {}, {} -- lists: the steps make no garbage
    if (target == nil) ~= (goals == nil) then
        error("corsac.tween: target and goals go together", 2)
    end
    for name, goal in pairs(goals or {}) do
        if type(goal) ~= "number" or type(target[name]) ~= "number" then
            error(("corsac.tween: goals.%s: expected numbers in goals and in target"):format(
                tostring(name)), 2)
        end
        local i = #names + 1
        names[i], first[i], last[i] = name, target[name], goal
    end
    local length, shape = steps(options.length), ease[options.ease or "smooth"]
    local from, to = options.from or 0, options.to or 1
    local at = 0
    local record
    record = {
        due = step + 1, every = 1, left = length,
        run = function()
            at = at + 1
            local t = shape(min(1, at / length))
            for i = 1, #names do
                target[names[i]] = first[i] + (last[i] - first[i]) * t
            end
            if options.step then options.step(from + (to - from) * t) end
            if at == length and options.done then options.done() end
        end,
    }
    return start(record)
end

-- Coroutines -------------------------------------------------------------------------------------

local function go(record, ...)
    engine.setTask(record.thread)
    local ok, what, value = resume(record.thread, ...)
    engine.setTask(nil)
    if not ok then
        finish(record)
        engine.report(record.thread, what)
    elseif status(record.thread) == "dead" then
        finish(record)
    elseif what == "wait" then
        record.due = step + steps(value)
    elseif what == "event" then
        record.due = math.huge
        lua["corsac.on"](value, function(...)
            if record.done then return false end
            record.due, record.values, record.valueCount = step + 1, { ... }, select("#", ...)
            return false -- hears it once
        end)
    else
        finish(record)
        error("corsac.spawn: a coroutine of the step yields by corsac.wait or corsac.waitFor only", 0)
    end
end

lua["corsac.spawn"] = function(fn, ...)
    local record = { thread = create(fn), due = math.huge }
    local task = start(record)
    local outer = engine.getTask()
    go(record, ...)
    engine.setTask(outer)
    return task
end

-- One step ---------------------------------------------------------------------------------------

local function runOne(record)
    if record.thread then
        local values, n = record.values, record.valueCount
        record.values = nil
        if values then go(record, unpack(values, 1, n)) else go(record) end
        return
    end
    record.left = record.left - 1
    record.due = record.due + record.every
    if record.left <= 0 then finish(record) end
    record.run()
end

function engine.tick()
    step = step + 1
    local known, kept = count, 0 -- tasks started during this step run in the next
    for i = 1, known do
        local record = tasks[i]
        if not record.done and record.due <= step then
            engine.protect(runOne, record)
        end
    end
    for i = 1, count do
        local record = tasks[i]
        if not record.done then
            kept = kept + 1
            tasks[kept] = record
        end
    end
    for i = kept + 1, count do tasks[i] = nil end
    count = kept
    return count > 0
end
