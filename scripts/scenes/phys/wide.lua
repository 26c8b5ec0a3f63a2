-- Two triangles of twenty kilometres. Far out on them cubes are dropped and a ball rolls as on small
-- ones.
local phys, scene, gfx = corsac.phys, corsac.scene, corsac.gfx
local far, cubes, ball = 3000, {}, nil

function corsac.conf(t)
  t.steps = 300
end

function corsac.load()
  local e = 1e4
  phys.newBody{ type = "static", shape = "mesh", friction = 0.5,
    points = { -e, 0, -e, e, 0, -e, e, 0, e, -e, 0, e }, triangles = { 1, 3, 2, 1, 4, 3 } }
  for i = 1, 8 do
    cubes[i] = scene.spawn{ position = { far + 1.5 * i, 1, far + 0.3 * i }, mesh = "box",
      rotation = { axis = { 1, 0, 1 }, angle = 0.3 * i }, color = { 0.9, 0.2 + 0.08 * i, 0.3 },
      body = { shape = "box", size = { 1, 1, 1 } } }
  end
  ball = scene.spawn{ position = { far, 0.5, far - 3 }, mesh = "sphere", color = { 0.3, 0.6, 0.9 },
    body = { shape = "sphere", radius = 0.5, velocity = { 3, 0, 0 }, angularVelocity = { 0, 0, -6 } } }
  gfx.setBackground(0.025, 0.03, 0.045)
  gfx.setAmbient(0.2, 0.22, 0.26)
  gfx.newLight{ type = "directional", direction = { -0.5, -1, -0.6 }, intensity = 2.8 }
  gfx.setCamera{ position = { far + 5, 6, far + 16 }, target = { far + 5, 0, far }, fov = 0.9,
    far = 200 }
end

function corsac.fixed()
  local worst = 0
  for _, cube in ipairs(cubes) do
    local _, y = cube:getPosition()
    worst = math.max(worst, math.abs(y - 0.5))
  end
  local _, y = ball:getPosition()
  corsac.metrics.set("worst_m", math.max(worst, math.abs(y - 0.5)))
  corsac.metrics.set("speed", (ball:getBody():getVelocity()))
end

corsac.expect("user.worst_m", "<=", 0.002)
corsac.expect("user.speed", ">=", 2.999)
corsac.expect("user.speed", "<=", 3.001)
