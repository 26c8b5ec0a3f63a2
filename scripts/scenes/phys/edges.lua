-- A ball and a box slide without friction over a floor of 8,192 triangles, across its edges at all
-- angles: they go straight on, at one height and speed.
local phys, scene, gfx = corsac.phys, corsac.scene, corsac.gfx
local n, ball, box = 64, nil, nil

function corsac.conf(t)
  t.steps = 300
end

local function floor()
  local points, triangles = {}, {}
  for j = 0, n do
    for i = 0, n do
      table.insert(points, 0.5 * i - 0.25 * n)
      table.insert(points, 0)
      table.insert(points, 0.5 * j - 0.25 * n)
    end
  end
  for j = 0, n - 1 do
    for i = 1, n do
      local a = j * (n + 1) + i
      local b, c, d = a + 1, a + n + 1, a + n + 2
      for _, corner in ipairs{ a, c, b, b, c, d } do
        table.insert(triangles, corner)
      end
    end
  end
  phys.newBody{ type = "static", shape = "mesh", points = points, triangles = triangles,
    friction = 0 }
  scene.spawn{ position = { 0, -0.5, 0 }, scale = { 0.5 * n, 1, 0.5 * n }, mesh = "box",
    color = { 0.42, 0.45, 0.52 } }
end

function corsac.load()
  floor()
  ball = scene.spawn{ position = { -12, 0.5, -6 }, mesh = "sphere", color = { 0.9, 0.5, 0.3 },
    body = { shape = "sphere", radius = 0.5, friction = 0, velocity = { 5, 0, 2.3 } } }
  box = scene.spawn{ position = { -12, 0.25, 6 }, mesh = "box", color = { 0.3, 0.6, 0.9 },
    body = { shape = "box", size = { 1, 0.5, 1 }, friction = 0, velocity = { 4, 0, -2.7 } } }
  gfx.setBackground(0.025, 0.03, 0.045)
  gfx.setAmbient(0.2, 0.22, 0.26)
  gfx.newLight{ type = "directional", direction = { -0.5, -1, -0.6 }, intensity = 2.8 }
  gfx.setCamera{ position = { 0, 9, 20 }, target = { 0, 0, 0 }, fov = 0.9, far = 200 }
end

local worst = 0
local function stray(entity, x, y, z, vx, vz)
  local px, py, pz = entity:getPosition()
  local aside = ((px - x) * vz - (pz - z) * vx) / math.sqrt(vx * vx + vz * vz)
  worst = math.max(worst, math.abs(aside), math.abs(py - y))
end

function corsac.fixed()
  stray(ball, -12, 0.5, -6, 5, 2.3)
  stray(box, -12, 0.25, 6, 4, -2.7)
  corsac.metrics.set("astray_m", worst)
  corsac.metrics.set("speed", (ball:getBody():getVelocity()))
end

corsac.expect("user.astray_m", "<=", 0.0002)
corsac.expect("user.speed", ">=", 4.9999)
corsac.expect("user.speed", "<=", 5.0001)
