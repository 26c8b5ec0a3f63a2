-- Convex hulls rain into a bin, and a ball is shot into the heap. n: hulls.
local scene, gfx = corsac.scene, corsac.gfx
local n = corsac.param("n", 200)
local ball

function corsac.conf(t)
  t.steps = 600
end

local function gem() -- corners on a squashed sphere
  local points, sx, sy, sz = {}, 0.35 + 0.15 * math.random(), 0.35 + 0.15 * math.random(),
    0.35 + 0.15 * math.random()
  for k = 0, 15 do
    local y = 1 - (2 * k + 1) / 16
    local r, a = math.sqrt(1 - y * y), 2.399963 * k
    points[3 * k + 1], points[3 * k + 2], points[3 * k + 3] =
      sx * r * math.cos(a), sy * y, sz * r * math.sin(a)
  end
  return points
end

function corsac.load()
  scene.spawn{ position = { 0, -1, 0 }, mesh = "box", color = { 0.42, 0.45, 0.52 },
    body = { type = "static", shape = "box", size = { 200, 2, 200 }, friction = 0.5 } }
  for k = 0, 3 do
    local s = k % 2 * 2 - 1
    scene.spawn{ position = k < 2 and { 4 * s, 3, 0 } or { 0, 3, 4 * s },
      body = { type = "static", shape = "box", size = k < 2 and { 1, 6, 9 } or { 9, 6, 1 } } }
  end
  local gems = {}
  for i = 1, 8 do
    gems[i] = gem()
  end
  for i = 0, n - 1 do
    scene.spawn{ mesh = "sphere", scale = { 0.8, 0.8, 0.8 }, color = { 0.4, 0.5 + 0.4 * math.random(), 0.7 },
      position = { i % 5 * 1.1 - 2.2, 1 + math.floor(i / 25) * 1.1, math.floor(i / 5) % 5 * 1.1 - 2.2 },
      rotation = { axis = { 0, 0.6, 0.8 }, angle = i },
      body = { shape = "hull", points = gems[i % 8 + 1] } }
  end
  ball = scene.spawn{ position = { 0, 20, 0 }, mesh = "sphere", color = { 0.95, 0.4, 0.2 },
    body = { shape = "sphere", radius = 0.3, velocity = { 0, -60, 0 } } }
  gfx.setBackground(0.025, 0.03, 0.045)
  gfx.setAmbient(0.2, 0.22, 0.26)
  gfx.newLight{ type = "directional", direction = { -0.5, -1, -0.6 }, intensity = 2.8 }
  gfx.setCamera{ position = { 9, 10, 14 }, target = { 0, 2, 0 }, fov = 0.9, far = 200 }
end

function corsac.fixed()
  local _, y = ball:getPosition()
  corsac.metrics.set("ball_y", y)
end

corsac.expect("user.ball_y", ">=", 0.25)
corsac.expect("accuracy.penetration_max_m", "<=", 0.01)
corsac.expect("accuracy.nan", "==", 0)
