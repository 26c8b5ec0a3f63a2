-- A walk and run in one blend tree, a hit on the upper body alone, and an additive look around.
local fox, upper, trees = nil, nil, {}

function corsac.load()
    corsac.gfx.setBackground(0.5, 0.62, 0.75)
    corsac.gfx.setAmbient(0.35, 0.36, 0.4)
    corsac.gfx.newLight{ type = "directional", direction = { -0.4, -1, -0.6 }, intensity = 2.2 }
    corsac.gfx.setCamera{ position = { 0.6, 0.9, 2 }, target = { 0, 0.25, 0 }, fov = 0.8 }
    corsac.scene.spawn{ mesh = "plane", scale = 12, color = { 0.3, 0.42, 0.2 } }
    fox = corsac.anim.loadModel("models/fox.cmodel")
    upper = corsac.anim.newMask(fox:getSkeleton(), { "spine" })
    local machine = corsac.anim.newMachine{
        parameters = { speed = 0 },
        states = { { name = "move", blendParameter = "speed", blend = {
            { clip = fox:getClip("idle"), value = 0 }, { clip = fox:getClip("walk"), value = 1 },
            { clip = fox:getClip("run"), value = 3 } } } },
    }
    for i = 1, 5 do
        trees[i] = corsac.scene.spawn{ model = fox, machine = machine,
            position = { (i - 3) * 0.45, 0, 0 } }:getAnimator()
        trees[i]:setParameter("speed", (i - 1) * 0.75)
    end
    trees[2]:setLayer{ layer = 1, clip = fox:getClip("hit"), mask = upper }
    trees[4]:setLayer{ layer = 1, clip = fox:getClip("turn"), additive = true, weight = 0.8 }
end

local step, kept, lowest, highest = 0, 0, 1, 0
function corsac.fixed()
    step = step + 1
    if step == 60 then trees[2]:setLayer{ layer = 1 } end
    -- The plain walker and the one with a layer on its upper body share their hind paws.
    local x, y, z = trees[2]:getBonePosition("hind_paw_l")
    local _, h = trees[5]:getBonePosition("hind_paw_l")
    lowest, highest = math.min(lowest, h), math.max(highest, h)
    if step > 1 and y > 0 and x > 0 and z < 0 then kept = kept + 1 end
    corsac.metrics.set("kept", kept)
    corsac.metrics.set("lift", highest - lowest)
end

corsac.expect("counts.skeletons", "==", 5)
corsac.expect("user.lift", ">", 0.03)
corsac.expect("user.kept", ">", 100)
corsac.expect("steady_allocations", "==", 0)
