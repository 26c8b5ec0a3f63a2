-- args: --steps 60 --keep-going
-- Callbacks that raise errors, wrong names and stale objects leave the machine valid.
local fox, animator, caught = nil, nil, 0

local function fails(text, f, ...)
    local good, message = pcall(f, ...)
    if not good and message:find(text, 1, true) then
        caught = caught + 1
    else
        print("expected an error with '" .. text .. "', got " .. tostring(message))
    end
end

function corsac.load()
    fox = corsac.anim.loadModel("models/fox.cmodel")
    fails('did you mean "walk"', fox.getClip, fox, "wlak")
    fails("models/wolf.cmodel", corsac.anim.loadModel, "models/wolf.cmodel")
    local idle, walk = fox:getClip("idle"), fox:getClip("walk")
    fails('no state "run"', corsac.anim.newMachine, {
        states = { { name = "idle", clip = idle } }, transitions = { { from = "run", to = "idle" } } })
    fails("give one of condition, event", corsac.anim.newMachine, {
        states = { { name = "idle", clip = idle } },
        transitions = { { to = "idle", event = "a", parameter = "b" } } })
    local machine = corsac.anim.newMachine{
        states = { { name = "idle", clip = idle }, { name = "walk", clip = walk } },
        transitions = { { from = "idle", to = "walk", event = "go", length = 0.1 } },
        parameters = { speed = 1 },
    }
    animator = corsac.scene.spawn{ model = fox, machine = machine }:getAnimator()
    fails('nearest is "speed"', animator.setParameter, animator, "sped", 1)
    fails('nearest is "go"', animator.send, animator, "og")
    fails("destroy them first", machine.destroy, machine)
    local other = corsac.anim.newSkeleton{ { name = "a" }, { name = "b", parent = "a", position = { 0, 1, 0 } } }
    fails("another skeleton", corsac.anim.newAnimator, other, machine)
    fails("not listed before", corsac.anim.newSkeleton, { { name = "a", parent = "b" }, { name = "b" } })
    fails("must be >= 0 and grow", corsac.anim.newClip, { skeleton = other, duration = 1,
        keys = { { bone = "b", time = 1 }, { bone = "b", time = 1 } } })
    local gone = corsac.anim.newAnimator(other)
    gone:destroy()
    fails("was destroyed", gone.getState, gone)
end

local step = 0
function corsac.fixed()
    step = step + 1
    if step == 10 then animator:send("go") end
    corsac.metrics.set("caught", caught)
    corsac.metrics.set("walking", animator:getState() == "walk" and 1 or 0)
end

corsac.expect("user.caught", "==", 11)
corsac.expect("user.walking", "==", 1)
