-- Bullets of 2 cm shot at each other, head on at 1,600 m/s: every pair meets.
local phys, scene, gfx = corsac.phys, corsac.scene, corsac.gfx
local n, left, right = 16, {}, {}

function corsac.conf(t)
  t.steps = 60
end

local function bullet(x, z, v)
  return scene.spawn{ position = { x, 0, z }, mesh = "sphere", color = { 0.9, 0.6, 0.2 },
    body = { shape = "sphere", radius = 0.02, density = 7800, friction = 0, velocity = { v, 0, 0 } } }
end

function corsac.load()
  phys.setGravity(0, 0, 0)
  for i = 1, n do
    left[i] = bullet(-20 - 13 * math.random(), i, 800)
    right[i] = bullet(20 + 13 * math.random(), i, -800)
  end
  gfx.setBackground(0.025, 0.03, 0.045)
  gfx.setAmbient(0.2, 0.22, 0.26)
  gfx.newLight{ type = "directional", direction = { -0.5, -1, -0.6 }, intensity = 2.8 }
  gfx.setCamera{ position = { 0, 14, 14 }, target = { 0, 0, 8 }, fov = 0.9, far = 200 }
end

function corsac.fixed()
  local passed = 0
  for i = 1, n do
    passed = passed + ((left[i]:getPosition()) > (right[i]:getPosition()) and 1 or 0)
  end
  corsac.metrics.set("passed", passed)
end

corsac.expect("user.passed", "==", 0)
