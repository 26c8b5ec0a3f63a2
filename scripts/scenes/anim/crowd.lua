-- A thousand foxes under one state machine: compressed clips, posed in blocks.
--   --set n=100            fewer
--   --set lod=1            when drawn, far and calm foxes are posed only when they are a pixel behind
--   --set anim.batch=off   the plain path;  --set anim.pack=0   raw keys
local foxes, step, jumps = {}, 0, 0
local lod = corsac.param("lod", 0)

local function make_machine(fox)
    return corsac.anim.newMachine{
        parameters = { speed = 0 },
        states = {
            { name = "idle", clip = fox:getClip("idle") },
            { name = "walk", clip = fox:getClip("walk") },
            { name = "run", clip = fox:getClip("run") },
            { name = "jump", clip = fox:getClip("jump"), loop = "once" },
        },
        transitions = {
            { from = "idle", to = "walk", parameter = "speed", value = 0.2, length = 0.25,
                fade = "smooth" },
            { from = "walk", to = "run", parameter = "speed", value = 1.2, length = 0.2, sync = true },
            { from = "run", to = "jump", event = "jump", length = 0.1 },
            { from = "jump", to = "run", length = 0.15, fade = "smooth" },
            { from = "run", to = "walk", parameter = "speed", compare = "<", value = 1.2, length = 0.2,
                sync = true },
            { from = "walk", to = "idle", parameter = "speed", compare = "<", value = 0.2,
                length = 0.25, fade = "smooth" },
        },
    }
end

function corsac.conf(t)
    t.anim = { pack = 0.0005, lod = lod }
end

function corsac.load()
    local n = corsac.param("n", 1000)
    corsac.expect("accuracy.anim_error_max_m_peak", "<=", lod > 0 and 0.05 * lod or 2e-6)
    corsac.gfx.setBackground(0.55, 0.65, 0.75)
    corsac.gfx.setAmbient(0.4, 0.4, 0.44)
    corsac.gfx.newLight{ type = "directional", direction = { -0.4, -1, -0.5 }, intensity = 2 }
    corsac.gfx.setCamera{ position = { 0, 4.5, 13 }, target = { 0, 0, 0 }, fov = 0.9 }
    corsac.scene.spawn{ mesh = "plane", scale = 60, color = { 0.3, 0.4, 0.22 } }
    local fox = corsac.anim.loadModel("models/fox.cmodel")
    local machine, side = make_machine(fox), math.ceil(math.sqrt(n))
    for i = 0, n - 1 do
        local x, z = i % side - (side - 1) / 2, math.floor(i / side) - (side - 1) / 2
        foxes[i + 1] = corsac.scene.spawn{ model = fox, machine = machine,
            position = { x * 0.75, 0, z * 1.1 } }:getAnimator()
    end
end

-- A wave of speed goes through the crowd; now and then a running fox jumps.
function corsac.fixed()
    step = step + 1
    for i = step % 8 + 1, #foxes, 8 do
        foxes[i]:setParameter("speed", 1 + math.sin(step * 0.02 + i * 0.05))
        if foxes[i]:getState() == "run" and (i * 7919 + step) % 97 == 0 then
            foxes[i]:send("jump")
            jumps = jumps + 1
        end
    end
    corsac.metrics.set("jumps", jumps)
end

corsac.expect("steady_allocations", "==", 0)
corsac.expect("user.jumps", ">", 10)
