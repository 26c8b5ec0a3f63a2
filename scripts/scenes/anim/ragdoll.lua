-- Foxes trot along a ledge, are knocked off it, tumble down the stairs, lie a while, and get up.
--   --set n=5      how many
local n = corsac.param("n", 5)
local foxes, lastY = {}, {}
local step, jump, deepest, resting, up = 0, 0, 0, 0, 0
local FALL, RISE = 60, 330 -- steps

function corsac.conf(t) t.steps = 420 end

function corsac.load()
    corsac.gfx.setBackground(0.5, 0.6, 0.72)
    corsac.gfx.setAmbient(0.36, 0.38, 0.42)
    corsac.gfx.newLight{ type = "directional", direction = { -0.5, -1, -0.4 }, intensity = 2.4, shadows = true }
    corsac.gfx.setCamera{ position = { 1.7, 1.5, 3.0 }, target = { -0.9, 0.35, -0.3 }, fov = 0.7 }
    corsac.phys.setCollisionRule("fox", "fox", true)
    local function block(x, y, z, size, color)
        corsac.scene.spawn{ position = { x, y, z }, mesh = "box", scale = size, color = color,
            body = { type = "static", shape = "box", size = size } }
    end
    block(0, -0.5, 0, { 8, 1, 8 }, { 0.34, 0.38, 0.3 })
    for i = 1, 5 do block(-0.9 - 0.2 * i, 0.06 * i, 0, { 0.2, 0.12 * i, 4 }, { 0.5, 0.47, 0.42 }) end
    block(-2.5, 0.36, 0, { 1, 0.72, 4 }, { 0.5, 0.47, 0.42 })
    local model = corsac.anim.loadModel("models/fox.cmodel")
    for i = 1, n do
        foxes[i] = corsac.scene.spawn{ model = model, clip = model:getClip("run"),
            position = { -2.3, 0.72, (i - (n + 1) / 2) * 0.7 }, rotation = { axis = { 0, 1, 0 }, angle = math.pi / 2 } }
    end
end

local function head(fox)
    local x, y, z = fox:getPosition()
    local hx, hy, hz = fox:getAnimator():getBonePosition("head")
    return x + hz, y + hy, z - hx -- the fox looks along +X
end

function corsac.fixed()
    step = step + 1
    for i, fox in ipairs(foxes) do
        local animator = fox:getAnimator()
        if step == FALL then animator:startRagdoll{ mass = 8, layer = "fox" } end
        if step == FALL + 1 then
            for _, body in ipairs(animator:getRagdoll()) do
                body:setVelocity(2.2 + 0.1 * i, 1.2, 0.2 * (i - 2))
            end
        end
        local _, y = head(fox)
        if step > FALL - 20 and step < FALL + 2 or step > RISE then
            jump = math.max(jump, math.abs(y - (lastY[i] or y)))
        end
        lastY[i] = y
        if step == RISE then
            local fast = 0
            for _, body in ipairs(animator:getRagdoll()) do
                local x, vy, z = body:getVelocity()
                local _, by = body:getPosition()
                fast = math.max(fast, math.sqrt(x * x + vy * vy + z * z))
                deepest = math.min(deepest, by)
            end
            if fast < 0.15 then resting = resting + 1 end
            animator:stopRagdoll(0.5)
        end
        if step == 410 and #animator:getRagdoll() == 0 and select(2, animator:getBonePosition("head")) > 0.25 then
            up = up + 1
        end
    end
    corsac.metrics.set("jump_m", jump)
    corsac.metrics.set("deepest_m", deepest)
    corsac.metrics.set("resting", resting)
    corsac.metrics.set("up", up)
end

corsac.expect("user.jump_m", "<=", 0.08) -- between two steps, when physics takes over and when it gives back
corsac.expect("user.deepest_m", ">=", -0.01)
corsac.expect("user.resting", "==", n)
corsac.expect("user.up", "==", n)
corsac.expect("accuracy.nan", "==", 0)
