-- The fox in each of its clips, and one led by a state machine.
local states, entered = {}, {}

local function machine(model)
    local function note(name)
        return function(animator)
            entered[#entered + 1] = name .. "<" .. animator:getState()
        end
    end
    return corsac.anim.newMachine{
        initial = "idle",
        parameters = { speed = 0 },
        states = {
            { name = "idle", clip = model:getClip("idle"), onEnter = note("idle") },
            { name = "walk", clip = model:getClip("walk"), onEnter = note("walk") },
            { name = "run", clip = model:getClip("run"), onEnter = note("run") },
            { name = "hit", clip = model:getClip("hit"), loop = "once", onExit = note("hit") },
        },
        transitions = {
            { to = "hit", event = "hit", length = 0.08 },
            { from = "hit", to = "idle", length = 0.2, fade = "smooth" },
            { from = "idle", to = "walk", parameter = "speed", value = 0.1, length = 0.25, fade = "smooth" },
            { from = "walk", to = "run", parameter = "speed", value = 1, length = 0.2, sync = true },
            { from = "run", to = "walk", parameter = "speed", compare = "<", value = 1, length = 0.2,
                sync = true },
            { from = "walk", to = "idle", length = 0.25,
                condition = function(animator) return animator:getParameter("speed") <= 0.1 end },
        },
    }
end

local leader
function corsac.load()
    corsac.gfx.setBackground(0.5, 0.62, 0.75)
    corsac.gfx.setAmbient(0.35, 0.36, 0.4)
    corsac.gfx.newLight{ type = "directional", direction = { -0.4, -1, -0.6 }, intensity = 2.2 }
    corsac.gfx.setCamera{ position = { 0.9, 0.95, 2.1 }, target = { 0, 0.25, 0 }, fov = 0.8 }
    corsac.scene.spawn{ mesh = "plane", scale = 12, color = { 0.3, 0.42, 0.2 } }
    local fox = corsac.anim.loadModel("models/fox.cmodel")
    for i, clip in ipairs(fox:getClips()) do
        corsac.scene.spawn{ model = fox, clip = clip, position = { (i - 3.5) * 0.42, 0, -0.25 } }
    end
    leader = corsac.scene.spawn{ model = fox, machine = machine(fox), position = { 0, 0, 0.75 } }:getAnimator()
end

local step = 0
function corsac.fixed()
    step = step + 1
    if step == 30 then leader:setParameter("speed", 0.5) end
    if step == 90 then leader:setParameter("speed", 2) end
    if step == 150 then leader:send("hit") end
    if step == 155 then leader:setParameter("speed", 0) end
    states[leader:getState()] = true
    corsac.metrics.set("states_seen", (states.idle and 1 or 0) + (states.walk and 1 or 0) +
        (states.run and 1 or 0) + (states.hit and 1 or 0))
    corsac.metrics.set("callbacks", #entered)
end

corsac.expect("counts.skeletons", "==", 7)
corsac.expect("counts.bones", "==", 7 * 24)
corsac.expect("accuracy.anim_error_max_m", "<=", 1e-5)
corsac.expect("accuracy.anim_error_max_m_peak", ">", 0)
corsac.expect("user.states_seen", "==", 4)
corsac.expect("user.callbacks", "==", 4)
corsac.expect("steady_allocations", "==", 0)
