-- Scene S1: balls fall into a bin and come to rest. n: balls.
local scene, gfx = corsac.scene, corsac.gfx
local n = corsac.param("n", 500)

function corsac.conf(t)
  t.steps = 900
end

function corsac.load()
  local m = math.ceil(1.25 * n ^ (1 / 3))
  local h = m * 0.55 + 0.5
  scene.spawn{ position = { 0, -1, 0 }, mesh = "box", color = { 0.42, 0.45, 0.52 },
    body = { type = "static", shape = "box", size = { 2 * h + 4, 2, 2 * h + 4 } } }
  for side = -1, 1, 2 do
    scene.spawn{ position = { side * (h + 0.5), 20, 0 },
      body = { type = "static", shape = "box", size = { 1, 40, 2 * h + 4 } } }
    scene.spawn{ position = { 0, 20, side * (h + 0.5) },
      body = { type = "static", shape = "box", size = { 2 * h + 4, 40, 1 } } }
  end
  for i = 0, n - 1 do
    local layer, r = math.floor(i / (m * m)), i % (m * m)
    local x = (r % m - (m - 1) / 2) * 1.1 + 0.08 * math.random() - 0.04
    local z = (math.floor(r / m) - (m - 1) / 2) * 1.1 + 0.08 * math.random() - 0.04
    scene.spawn{ position = { x, 1 + 1.1 * layer, z }, mesh = "sphere",
      color = { 0.9, 0.3 + 0.5 * i / n, 0.3 }, body = { shape = "sphere", radius = 0.5 } }
  end
  gfx.setBackground(0.025, 0.03, 0.045)
  gfx.setAmbient(0.2, 0.22, 0.26)
  gfx.newLight{ type = "directional", direction = { -0.5, -1, -0.6 }, intensity = 2.8 }
  gfx.setCamera{ position = { 0, 12, 17 }, target = { 0, 3, 0 }, fov = 0.9, far = 200 }
end

-- All of them asleep at the end: at rest for good.
corsac.expect("counts.awake", "==", 0)
corsac.expect("accuracy.penetration_max_m", "<=", 0.01)
corsac.expect("accuracy.penetration_mean_m", "<=", 0.0005)
corsac.expect("accuracy.tunnelled", "==", 0)
