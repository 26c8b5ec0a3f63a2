-- A lift: cabin and counterweight on one rope over two wheels, the cabin on a rail. A winch lifts it
-- at half a metre a second to the upper end of its rope's range, where it holds.
local phys, scene, gfx = corsac.phys, corsac.scene, corsac.gfx
local cabin, counter, rope, rail
local steps = 0

function corsac.conf(t)
  t.steps = 600
end

local function box(x, y, size, mass, color)
  return scene.spawn{ position = { x, y, 0 }, mesh = "box", color = color,
    body = { shape = "box", size = size, density = mass / (size[1] * size[2] * size[3]) } }:getBody()
end

function corsac.load()
  cabin = box(0, 0, { 1.2, 1.6, 1.2 }, 500, { 0.75, 0.55, 0.3 })
  counter = box(2, 4, { 0.4, 1, 0.8 }, 400, { 0.4, 0.45, 0.5 })
  rail = phys.newJoint{ type = "prismatic", b = cabin, anchor = { 0, 0, 0 }, axis = { 0, 1, 0 } }
  phys.newJoint{ type = "prismatic", b = counter, anchor = { 2, 4, 0 }, axis = { 0, 1, 0 } }
  rope = phys.newJoint{ type = "pulley", a = cabin, b = counter, anchor = { 0, 0.8, 0 },
    anchorB = { 2, 4.5, 0 }, groundA = { 0, 6, 0 }, groundB = { 2, 6, 0 }, lower = 2.2, upper = 5.2,
    motorSpeed = -0.5, motorMax = 4000 }
  gfx.setBackground(0.025, 0.03, 0.045)
  gfx.setAmbient(0.2, 0.22, 0.26)
  gfx.newLight{ type = "directional", direction = { -0.5, -1, -0.6 }, intensity = 2.8 }
  gfx.setCamera{ position = { 1, 3, 10 }, target = { 1, 2.8, 0 }, fov = 0.8, far = 200 }
end

function corsac.fixed()
  steps = steps + 1
  local _, speed = cabin:getVelocity()
  if steps == 180 then -- half way: constant speed, so the rope bears the counterweight
    local _, force = rope:getForce()
    corsac.metrics.set("speed_m_s", speed)
    corsac.metrics.set("rope_over_weight", force / (400 * 9.81))
  end
  corsac.metrics.set("height_m", rail:getValue())
  corsac.metrics.set("rope_m", rope:getValue())
end

function corsac.draw()
  local _, a = cabin:getPosition()
  local _, b = counter:getPosition()
  gfx.drawPath({ 0, a + 0.8, 0, 0, 6, 0, 2, 6, 0, 2, b + 0.5, 0 }, { color = { 0.9, 0.8, 0.6 } })
end

corsac.expect("user.speed_m_s", ">=", 0.495)
corsac.expect("user.speed_m_s", "<=", 0.505)
corsac.expect("user.rope_over_weight", ">=", 0.99)
corsac.expect("user.rope_over_weight", "<=", 1.01)
corsac.expect("user.height_m", ">=", 2.999)
corsac.expect("user.height_m", "<=", 3.001)
corsac.expect("user.rope_m", ">=", 2.199)
corsac.expect("accuracy.joint_error_max_m", "<=", 0.001)
