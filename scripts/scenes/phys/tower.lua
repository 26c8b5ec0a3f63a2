-- Forty cubes on top of each other, each 1 cm off: a tower that most engines lose within seconds.
-- n: cubes.
local scene, gfx = corsac.scene, corsac.gfx
local n = corsac.param("n", 40)
local top

function corsac.conf(t)
  t.steps = 600
end

function corsac.load()
  scene.spawn{ position = { 0, -1, 0 }, mesh = "box", color = { 0.42, 0.45, 0.52 },
    body = { type = "static", shape = "box", size = { 200, 2, 200 }, friction = 0.5 } }
  for i = 0, n - 1 do
    local x, z = math.random() * 0.02 - 0.01, math.random() * 0.02 - 0.01
    top = scene.spawn{ position = { x, 0.5 + i, z }, mesh = "box",
      color = { 0.9 - 0.5 * i / n, 0.5, 0.25 + 0.5 * i / n },
      body = { shape = "box", size = { 1, 1, 1 } } }
  end
  gfx.setBackground(0.025, 0.03, 0.045)
  gfx.setAmbient(0.2, 0.22, 0.26)
  gfx.newLight{ type = "directional", direction = { -0.5, -1, -0.6 }, intensity = 2.8 }
  gfx.setCamera{ position = { 26, 22, 40 }, target = { 0, 18, 0 }, fov = 0.9, far = 200 }
end

function corsac.fixed()
  local _, y = top:getPosition()
  corsac.metrics.set("sag_m", n - 0.5 - y)
end

corsac.expect("user.sag_m", "<=", 0.04)
corsac.expect("accuracy.penetration_max_m", "<=", 0.005)
