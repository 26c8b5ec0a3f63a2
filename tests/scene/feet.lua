-- args: --steps 150
-- Feet stand on the ground: a fox on the flat tells how high its paws are; on stairs and on a slope each paw
-- is as high over the ground below it. A walking fox keeps its paws out of the stairs.
local RISE, RUN, SLOPE = 0.03, 0.16, 0.15
local paws = { "front_paw_l", "front_paw_r", "hind_paw_l", "hind_paw_r" }
local foxes, ground = {}, {}

local function box(x, y, z, size, angle)
    corsac.phys.newBody{ type = "static", shape = "box", size = size, position = { x, y, z }, layer = "ground",
        rotation = angle and { axis = { 1, 0, 0 }, angle = angle } }
end

ground[1] = function() return 0 end
ground[2] = function(z) return RISE * math.floor(z / RUN + 0.5) end
ground[3] = function(z) return -math.tan(SLOPE) * z end

function corsac.load()
    local model = corsac.anim.loadModel("models/fox.cmodel")
    box(0, -0.5, 0, { 2, 1, 4 })
    for i = -8, 8 do box(4, RISE * i - 0.5, RUN * i, { 2, 1, RUN }) end
    box(8, -0.5 / math.cos(SLOPE), 0, { 2, 1, 6 }, SLOPE)
    for i = 1, 3 do
        foxes[i] = corsac.scene.spawn{ model = model, clip = model:getClip("idle"), position = { 4 * i - 4, 0, 0 },
            body = { type = "kinematic", shape = "sphere", radius = 0.2, layer = "fox" } }
        foxes[i]:getAnimator():setFeet{ bones = paws, root = "hips", layer = "ground" }
    end
end

local step, worst, moved = 0, 0, 0
function corsac.fixed()
    step = step + 1
    if step < 60 then return end
    if step == 149 then
        for _, paw in ipairs(paws) do
            local _, flat = foxes[1]:getAnimator():getBonePosition(paw)
            local _, y = foxes[2]:getAnimator():getBonePosition(paw)
            assert(math.abs(y - flat) < 1e-4, "the animation has its feet again")
        end
    end
    if step > 140 then return end
    for k, paw in ipairs(paws) do
        local _, flat = foxes[1]:getAnimator():getBonePosition(paw)
        for i = 2, 3 do
            local _, y, z = foxes[i]:getAnimator():getBonePosition(paw)
            worst = math.max(worst, math.abs(y - ground[i](z) - flat))
            moved = math.max(moved, math.abs(ground[i](z)))
        end
    end
    corsac.metrics.set("worst_m", worst)
    corsac.metrics.set("moved_m", moved)
    if step == 140 then
        foxes[2]:getAnimator():setFeet{ bones = {}, root = "hips" }
        assert(not pcall(foxes[2].getAnimator(foxes[2]).setFeet, foxes[2]:getAnimator(),
            { bones = { "front_paw_x" }, root = "hips" }))
    end
end

corsac.expect("user.worst_m", "<=", 0.003)
corsac.expect("user.moved_m", ">=", 0.02)
corsac.expect("steady_allocations", "==", 0)
