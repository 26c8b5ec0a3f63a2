-- A course for a character: ramp, stairs, a turning disc, a crate to push, a low gate, a jump. It
-- must come through in time.
local phys, scene, gfx = corsac.phys, corsac.scene, corsac.gfx
local mover, figure
local goal = 1
local way = { { 4, 0 }, { 9, 0 }, { 14, 0 }, { 14, 6 }, { 8, 6 }, { 3, 6 }, { -2, 6 } }

function corsac.conf(t)
  t.steps = 1200
end

local function box(x, y, z, sx, sy, sz, color, more)
  local body = { type = "static", shape = "box", size = { sx, sy, sz } }
  for k, v in pairs(more or {}) do
    body[k] = v
  end
  return scene.spawn{ position = { x, y, z }, mesh = "box", color = color, body = body }
end

function corsac.load()
  local stone, wood = { 0.45, 0.5, 0.55 }, { 0.7, 0.5, 0.3 }
  box(6, -0.5, 3, 30, 1, 20, { 0.25, 0.3, 0.28 })
  local ramp = box(2.2, 0.15, 0, 3, 0.2, 2, stone)
  ramp:setRotation(0, 0, math.sin(0.2), math.cos(0.2))
  box(5.5, 0.4, 0, 4.2, 0.8, 2, stone)
  for i = 1, 4 do
    box(7.4 + 0.5 * i, 0.5 - 0.1 * i, 0, 0.5, 1 - 0.2 * i, 2, stone)
  end
  scene.spawn{ position = { 14, 0.1, 3 }, mesh = "cylinder", color = { 0.3, 0.5, 0.7 },
    body = { type = "kinematic", shape = "cylinder", radius = 1.6, height = 0.2 } }
    :getBody():setAngularVelocity(0, 0.6, 0)
  box(11, 0.4, 6, 0.8, 0.8, 0.8, wood, { type = "dynamic", density = 60 })
  box(6.5, 0.2, 6, 0.3, 0.4, 3, stone)
  box(3, 2, 6, 0.6, 1.4, 3, stone)
  mover = phys.newMover{ position = { -1, 0.9, 0 }, pushForce = 300 }
  figure = scene.spawn{ mesh = "capsule", scale = { 0.3, 0.6, 0.3 }, color = { 0.9, 0.7, 0.2 } }
  gfx.setBackground(0.02, 0.03, 0.05)
  gfx.setAmbient(0.25, 0.27, 0.3)
  gfx.newLight{ type = "directional", direction = { -0.5, -1, -0.6 }, intensity = 2.8 }
  gfx.setCamera{ position = { 5, 9, 16 }, target = { 6, 0, 3 }, fov = 0.9, far = 200 }
end

function corsac.fixed()
  local x, y, z = mover:getPosition()
  figure:setPosition(x, y, z)
  local to = way[goal]
  if not to then
    mover:walk(0, 0, 0)
    return
  end
  local dx, dz = to[1] - x, to[2] - z
  local far = math.sqrt(dx * dx + dz * dz)
  if far < 0.3 then
    goal = goal + 1
    corsac.metrics.set("reached", goal - 1)
    return
  end
  mover:walk(3 * dx / far, 0, 3 * dz / far)
  local vx = mover:getVelocity()
  local ground = mover:getGround()
  if ground == "ground" and math.abs(vx) < 0.1 and goal == 5 then
    mover:jump(3.5)
  end
  mover:resize(0.3, x > 2 and x < 4.2 and z > 5 and 1.2 or 1.8)
end

corsac.expect("user.reached", "==", 7)
