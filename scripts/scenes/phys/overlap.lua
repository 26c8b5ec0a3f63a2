-- Twelve cubes inside one another part without an explosion.
local scene, gfx = corsac.scene, corsac.gfx
local cubes = {}

function corsac.conf(t)
  t.steps = 480
end

function corsac.load()
  scene.spawn{ position = { 0, -1, 0 }, mesh = "box", color = { 0.42, 0.45, 0.52 },
    body = { type = "static", shape = "box", size = { 200, 2, 200 }, friction = 0.5 } }
  for i = 1, 12 do
    cubes[i] = scene.spawn{ mesh = "box", color = { 0.9, 0.3 + 0.05 * i, 0.3 },
      position = { 0.1 * math.random(), 1 + 0.05 * i, 0.1 * math.random() },
      body = { shape = "box", size = { 1, 1, 1 } } }
  end
  gfx.setBackground(0.025, 0.03, 0.045)
  gfx.setAmbient(0.2, 0.22, 0.26)
  gfx.newLight{ type = "directional", direction = { -0.5, -1, -0.6 }, intensity = 2.8 }
  gfx.setCamera{ position = { 4, 4, 9 }, target = { 0, 1, 0 }, fov = 0.9, far = 200 }
end

local fastest = 0
function corsac.fixed()
  for _, cube in ipairs(cubes) do
    local x, y, z = cube:getBody():getVelocity()
    fastest = math.max(fastest, math.sqrt(x * x + y * y + z * z))
  end
  corsac.metrics.set("fastest", fastest)
end

corsac.expect("user.fastest", "<=", 16)
corsac.expect("accuracy.penetration_max_m", "<=", 0.005)
