-- Inverse kinematics: foxes stand across stairs, each paw on the step below it, and look at a ball.
local RISE, RUN = 0.04, 0.16 -- m
local foxes, ball = {}, nil
local paws = { "front_paw_l", "front_paw_r", "hind_paw_l", "hind_paw_r" }

local function ground(z)
    return RISE * math.max(0, math.floor(z / RUN) + 4)
end

function corsac.load()
    corsac.gfx.setBackground(0.5, 0.62, 0.75)
    corsac.gfx.setAmbient(0.35, 0.36, 0.4)
    corsac.gfx.newLight{ type = "directional", direction = { -0.4, -1, -0.6 }, intensity = 2.2 }
    corsac.gfx.setCamera{ position = { 2, 1, 0.9 }, target = { 0, 0.45, 0 }, fov = 0.7 }
    for i = -4, 4 do
        local h = math.max(ground((i + 0.5) * RUN), 0.01)
        corsac.scene.spawn{ position = { 0, h / 2, (i + 0.5) * RUN }, mesh = "box",
            scale = { 3, h, RUN }, color = { 0.55, 0.5, 0.45 } }
    end
    local model = corsac.anim.loadModel("models/fox.cmodel")
    for i = 1, 3 do
        foxes[i] = corsac.scene.spawn{ model = model, clip = model:getClip("idle"),
            position = { (i - 2) * 0.5, ground(0) - 2 * RISE, 0 } }
    end
    ball = corsac.scene.spawn{ position = { 0, 1, 1.5 }, mesh = "sphere", scale = 0.08,
        color = { 0.9, 0.2, 0.2 } }
end

-- Written over in every step: a step makes no garbage.
local reach = { goal = 1, bone = "", keepRotation = true, target = { 0, 0, 0 } }
local look = { goal = 5, kind = "look", bone = "head", limit = 1, target = { 0, 0, 0 } }
local step, worst, turned = 0, 0, 0

function corsac.fixed()
    step = step + 1
    local bx, by, bz = 0.9 * math.sin(step * 0.03), 0.9, 1.3
    ball:setPosition(bx, by, bz)
    for _, fox in ipairs(foxes) do
        local animator = fox:getAnimator()
        local x, y, z = fox:getPosition()
        if step > 2 then
            for _, paw in ipairs(paws) do
                local px, py, pz = animator:getBonePosition(paw)
                worst = math.max(worst, math.abs(py + y - ground(pz + z) - 0.035))
                turned = math.max(turned, math.abs(px))
            end
        end
        for k, paw in ipairs(paws) do
            local side = k % 2 == 1 and 0.06 or -0.06
            local pz = k <= 2 and 0.14 or -0.19
            local at = reach.target
            reach.goal, reach.bone = k, paw
            at[1], at[2], at[3] = side, ground(z + pz) - y + 0.035, pz
            animator:setGoal(reach)
        end
        local at = look.target
        at[1], at[2], at[3] = bx - x, by - y, bz - z
        animator:setGoal(look)
    end
    corsac.metrics.set("worst_paw_m", worst)
    corsac.metrics.set("reach", turned)
end

corsac.expect("user.worst_paw_m", "<=", 2e-4)
corsac.expect("user.reach", ">", 0.05)
corsac.expect("steady_allocations", "==", 0)
