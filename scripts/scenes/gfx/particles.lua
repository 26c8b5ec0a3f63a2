-- Particles: a fire with sparks and smoke, a fountain, snow, a comet that follows a body.
-- n: how many particles more or less are alive, beside 1 times what is written here.
local n = corsac.param("n", 1)

local gfx, scene = corsac.gfx, corsac.scene

function corsac.conf(t)
    t.steps = 150
    t.size = { 960, 540 }
end

local function addFire(x, z)
    gfx.newEmitter{ position = { x, 0.15, z }, shape = "sphere", extent = { 0.3, 0.05, 0.3 }, rate = 140 * n,
        life = { 0.5, 1.1 }, speed = { 0.6, 1.4 }, spread = 0.25, acceleration = { 0, 1.6, 0 }, spin = { -2, 2 },
        size = { 0.35, 0.5, 0.3, 0.05 }, sizeVary = 0.4, additive = true, seed = 1,
        colors = { 1.2, 0.5, 0.12, 0.5, 1.4, 0.4, 0.06, 0.5, 0.7, 0.12, 0.02, 0.3, 0.2, 0.03, 0, 0 } }
    gfx.newEmitter{ position = { x, 0.4, z }, rate = 25 * n, life = { 0.6, 1.6 }, speed = { 1.5, 3 }, spread = 0.5,
        acceleration = { 0, -2, 0 }, drag = 0.6, size = { 0.05, 0.03 }, additive = true, seed = 2,
        colors = { 6, 3, 1, 1, 3, 0.8, 0.1, 0 } }
    gfx.newEmitter{ position = { x, 1.1, z }, shape = "sphere", extent = { 0.2, 0.1, 0.2 }, rate = 18 * n,
        life = { 2, 3 }, speed = { 0.5, 1 }, spread = 0.3, drag = 0.4, wind = { 0.6, 0.7, 0 }, spin = { -0.6, 0.6 },
        size = { 0.4, 1, 1.6 }, sizeVary = 0.3, seed = 3,
        colors = { 0.05, 0.05, 0.05, 0, 0.07, 0.07, 0.08, 0.35, 0.12, 0.12, 0.13, 0 } }
end

function corsac.load()
    gfx.setEnvironment{ intensity = 0.25 }
    gfx.newLight{ type = "directional", direction = { 1, -1.2, -0.6 }, intensity = 0.7, color = { 0.7, 0.8, 1 } }
    gfx.newLight{ position = { -2.5, 1, 0 }, color = { 1, 0.5, 0.15 }, intensity = 6, radius = 9 }
    scene.spawn{ mesh = "box", position = { 0, -0.5, 0 }, color = { 0.3, 0.32, 0.3 },
        body = { type = "static", shape = "box", size = { 24, 1, 24 } } }
    for i = 1, 5 do
        local a = 1.2566 * i
        scene.spawn{ mesh = "cylinder", position = { -2.5 + 0.3 * math.cos(a), 0.1, 0.3 * math.sin(a) },
            scale = { 0.16, 0.9, 0.16 }, rotation = { axis = { -math.sin(a), 0, math.cos(a) }, angle = 1.2 },
            color = { 0.35, 0.22, 0.12 } }
    end
    addFire(-2.5, 0)
    scene.spawn{ mesh = "cylinder", position = { 2.5, 0.2, -0.5 }, scale = { 2.2, 0.4, 2.2 },
        color = { 0.5, 0.5, 0.55 } }
    gfx.newEmitter{ position = { 2.5, 0.5, -0.5 }, rate = 500 * n, life = { 1.25, 1.35 }, speed = { 5.6, 6 },
        spread = 0.12, acceleration = { 0, -9.81, 0 }, size = { 0.05, 0.09 }, seed = 4,
        colors = { 0.75, 0.85, 1, 0.5, 0.6, 0.75, 0.95, 0.35 } }
    gfx.newEmitter{ position = { 0, 6, 0 }, shape = "box", extent = { 9, 0.2, 6 }, rate = 120 * n, life = { 7, 8 },
        speed = { 0.6, 0.9 }, rotation = { axis = { 1, 0, 0 }, angle = math.pi }, spread = 0.3, drag = 0.3,
        wind = { 0.25, -0.8, 0 }, size = { 0.05 }, sizeVary = 0.5, colors = { 0.9, 0.95, 1, 0.8 }, seed = 5 }
    local ball = scene.spawn{ mesh = "sphere", position = { -6, 1, -4 }, scale = { 0.4, 0.4, 0.4 },
        color = { 0.4, 0.7, 1 }, body = { shape = "sphere", radius = 0.2, velocity = { 4.2, 9, 0.5 } } }
    gfx.newEmitter{ rate = 200 * n, life = { 0.8, 1.2 }, speed = { 0, 0.3 }, spread = math.pi, size = { 0.22, 0 },
        colors = { 0.4, 0.8, 2, 1, 0.1, 0.2, 1, 0 }, additive = true, seed = 6 }:follow(ball)
    gfx.setCamera{ position = { 0.4, 2.4, 7.5 }, target = { 0, 1.2, 0 } }
end
