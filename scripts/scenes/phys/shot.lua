-- A ball is shot at 200 m/s into a hull that lies against a wall: it stays neither in the one nor
-- behind the other.
local scene, gfx = corsac.scene, corsac.gfx
local ball, hull

function corsac.conf(t)
  t.steps = 300
end

function corsac.load()
  scene.spawn{ position = { 0, -1, 0 }, mesh = "box", color = { 0.42, 0.45, 0.52 },
    body = { type = "static", shape = "box", size = { 200, 2, 200 }, friction = 0.5 } }
  scene.spawn{ position = { 3, 18, 0 }, mesh = "box", color = { 0.42, 0.45, 0.52 },
    body = { type = "static", shape = "box", size = { 0.2, 40, 40 } } }
  local points = {}
  for i = 0, 15 do
    local a, y = i * 2.39996, 1 - (2 * i + 1) / 16
    local r = math.sqrt(1 - y * y)
    for _, value in ipairs{ 0.9 * r * math.cos(a), 0.7 * y, 0.9 * r * math.sin(a) } do
      table.insert(points, value)
    end
  end
  hull = scene.spawn{ position = { 2, 0.8, 0 }, body = { shape = "hull", points = points } }
  scene.spawn{ parent = hull, mesh = "sphere", scale = { 1.7, 1.3, 1.7 }, color = { 0.7, 0.6, 0.4 } }
  ball = scene.spawn{ position = { -6, 0.9, 0.1 }, mesh = "sphere", color = { 0.9, 0.5, 0.3 },
    body = { shape = "sphere", radius = 0.15, density = 7800, velocity = { 200, 0, 0 } } }
  gfx.setBackground(0.025, 0.03, 0.045)
  gfx.setAmbient(0.2, 0.22, 0.26)
  gfx.newLight{ type = "directional", direction = { -0.5, -1, -0.6 }, intensity = 2.8 }
  gfx.setCamera{ position = { -4, 4, 8 }, target = { 0, 1, 0 }, fov = 0.9, far = 200 }
end

local most = -10
function corsac.fixed()
  local x = ball:getPosition()
  most = math.max(most, x, (hull:getPosition()))
  corsac.metrics.set("furthest_x", most)
end

corsac.expect("user.furthest_x", "<=", 2.9)
corsac.expect("accuracy.penetration_max_m", "<=", 0.005)
corsac.expect("accuracy.nan", "==", 0)
