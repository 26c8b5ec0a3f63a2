-- The guide's game: a hundred boxes fall, a fox walks to a plate, the plate opens a door. Three
-- lights, a sound, and a mod that changes gravity: --mod scripts/mods/moon
local scene, phys, gfx, anim, nav, audio =
    corsac.scene, corsac.phys, corsac.gfx, corsac.anim, corsac.nav, corsac.audio

local world = corsac.persist("world", { doorOpen = 0, visits = 0 })
local door, fox, agent

local function addRoom()
    scene.spawn{
        position = { 0, -0.5, 0 }, mesh = "box", color = { 0.35, 0.38, 0.42 },
        body = { type = "static", shape = "box", size = { 24, 1, 24 } },
    }
    for _, x in ipairs{ -3.5, 3.5 } do
        scene.spawn{
            position = { x, 1, -3 }, mesh = "box", color = { 0.5, 0.46, 0.4 },
            body = { type = "static", shape = "box", size = { 5, 2, 0.4 } },
        }
    end
    door = scene.spawn{
        position = { 0, 1, -3 }, mesh = "box", color = { 0.75, 0.35, 0.15 },
        body = { type = "kinematic", shape = "box", size = { 2, 2, 0.3 } },
    }
end

local function addBoxes()
    local crate = scene.newPrefab{ mesh = "box", body = { shape = "box", size = 0.4, density = 300 } }
    for i = 0, 99 do
        crate:spawn{
            position = { 4 + i % 5 * 0.5, 1 + math.floor(i / 25) * 0.6, 3 + math.floor(i / 5) % 5 * 0.5 },
            color = { 0.9 - i * 0.004, 0.5, 0.2 + i * 0.005 },
        }
    end
end

local function addFox()
    local model = anim.loadModel("models/fox.cmodel")
    local walker = scene.spawn{ -- agents look along -Z, the model along +Z
        position = { -6, 0, 4 },
        body = { type = "kinematic", shape = "sphere", radius = 0.25, layer = "fox" },
    }
    fox = scene.spawn{
        model = model, parent = walker, rotation = { axis = { 0, 1, 0 }, angle = math.pi },
        machine = anim.newMachine{
            initial = "idle", parameters = { speed = 0 },
            states = {
                { name = "idle", clip = model:getClip("idle") },
                { name = "walk", clip = model:getClip("walk") },
            },
            transitions = {
                { from = "idle", to = "walk", parameter = "speed", value = 0.1, length = 0.2 },
                { from = "walk", to = "idle", parameter = "speed", compare = "<", value = 0.1, length = 0.2 },
            },
        },
    }
    local graph = nav.newGraph{ name = "floor" }
    local a, b, c = graph:add(-6, 0, 4), graph:add(-3, 0, 1), graph:add(0, 0, 0)
    graph:connect(a, b)
    graph:connect(b, c)
    agent = nav.newAgent{ entity = walker, maxSpeed = 1.2, turnRate = 6 }
    agent:go(graph, 0, 0, 0)
end

local function addPlate()
    local chime = audio.newSound("sounds/chime.wav")
    scene.spawn{ position = { 0, 0.01, 0 }, mesh = "cylinder", scale = { 1.6, 0.02, 1.6 }, color = { 0.9, 0.8, 0.3 } }
    phys.newTrigger{
        shape = "box", size = { 1.6, 1, 1.6 }, position = { 0, 0.5, 0 }, layer = "fox",
        onEnter = function()
            world.visits = world.visits + 1
            audio.newSource{ sound = chime, position = { 0, 1, -3 } }
            corsac.tween{ length = 1.5, target = world, goals = { doorOpen = 1 }, ease = "smooth" }
        end,
    }
end

function corsac.load()
    phys.setGravity(0, -9.81, 0)
    addRoom()
    addBoxes()
    addFox()
    addPlate()
    gfx.setBackground(0.03, 0.04, 0.06)
    gfx.setAmbient(0.15, 0.16, 0.2)
    gfx.newLight{ type = "directional", direction = { -0.4, -1, -0.5 }, intensity = 1.8 }
    gfx.newLight{ position = { -4, 3, 2 }, color = { 1, 0.6, 0.3 }, intensity = 14, radius = 12 }
    gfx.newLight{ type = "spot", position = { 0, 5, 0 }, intensity = 40, inner = 0.25, outer = 0.4 }
    gfx.setCamera{ position = { -7, 5, 9 }, target = { 0, 0.6, 0 }, fov = 0.8 }
    corsac.expect("user.visits", "==", 1)
    corsac.expect("user.door", ">", 1.9)
end

function corsac.fixed()
    local vx, _, vz = agent:getVelocity()
    fox:getAnimator():setParameter("speed", math.sqrt(vx * vx + vz * vz))
    door:setPosition(2 * world.doorOpen, 1, -3)
    corsac.metrics.set("visits", world.visits)
    corsac.metrics.set("door", (door:getPosition()))
end
