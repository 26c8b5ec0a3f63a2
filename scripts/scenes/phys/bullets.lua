-- Bullets of 5 cm at 100 to 2,000 m/s against paper: a wall of 20 mm. None passes. speed: of the
-- fastest.
local phys, scene, gfx = corsac.phys, corsac.scene, corsac.gfx
local speed = corsac.param("speed", 2000)
local bullets = {}

function corsac.conf(t)
  t.steps = 60
end

function corsac.load()
  phys.setGravity(0, 0, 0)
  scene.spawn{ position = { 0, 0, 0 }, mesh = "box", color = { 0.8, 0.78, 0.7 },
    body = { type = "static", shape = "box", size = { 0.02, 12, 12 } } }
  for i = 1, 20 do
    local v = speed * i / 20
    bullets[i] = scene.spawn{ position = { -1 - v / 60 * math.random(), (i % 5) * 2 - 4, i / 2 - 5 },
      mesh = "sphere", color = { 0.9, 0.6, 0.2 },
      body = { shape = "sphere", radius = 0.05, density = 7800, velocity = { v, 0, 0 } } }
  end
  gfx.setBackground(0.025, 0.03, 0.045)
  gfx.setAmbient(0.2, 0.22, 0.26)
  gfx.newLight{ type = "directional", direction = { -0.5, -1, -0.6 }, intensity = 2.8 }
  gfx.setCamera{ position = { -9, 5, 9 }, target = { 0, 0, 0 }, fov = 0.9, far = 200 }
end

function corsac.fixed()
  local through = 0
  for _, bullet in ipairs(bullets) do
    through = through + ((bullet:getPosition()) > 0 and 1 or 0)
  end
  corsac.metrics.set("through", through)
end

corsac.expect("user.through", "==", 0)
