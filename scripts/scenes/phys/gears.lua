-- A train of four wheels joined by pivots: each turns the other way, as fast as its radius says.
local phys, scene, gfx = corsac.phys, corsac.scene, corsac.gfx
local radii = { 0.4, 0.8, 0.3, 1.2 }
local wheels = {}

function corsac.conf(t)
  t.steps = 600
end

function corsac.load()
  phys.setCollisionRule("gear", "gear", false)
  local x = 0
  for i, r in ipairs(radii) do
    x = x + (i > 1 and radii[i - 1] + r or 0)
    local wheel = scene.spawn{ position = { x, 0, 0 }, mesh = "box", color = { 0.9, 0.2 * i, 0.3 },
      body = { shape = "box", size = { 1.6 * r, 1.6 * r, 0.2 }, layer = "gear" } }:getBody()
    phys.newJoint{ type = "revolute", b = wheel, anchor = { x, 0, 0 }, axis = { 0, 0, 1 },
      motorSpeed = 4, motorMax = i == 1 and 500 or 0 }
    if i > 1 then
      phys.newJoint{ type = "pivot", a = wheels[i - 1], b = wheel, axis = { 0, 0, 1 },
        ratio = -r / radii[i - 1] }
    end
    wheels[i] = wheel
  end
  gfx.setBackground(0.025, 0.03, 0.045)
  gfx.setAmbient(0.2, 0.22, 0.26)
  gfx.newLight{ type = "directional", direction = { -0.5, -1, -0.6 }, intensity = 2.8 }
  gfx.setCamera{ position = { 2.5, 1.5, 6 }, target = { 2.2, 0, 0 }, fov = 0.9, far = 200 }
end

local function speed(i)
  local _, _, z = wheels[i]:getAngularVelocity()
  return z
end

function corsac.fixed()
  corsac.metrics.set("first", speed(1))
  corsac.metrics.set("ratio", speed(4) / math.max(speed(1), 0.01))
end

corsac.expect("user.first", ">=", 3.99)
corsac.expect("user.ratio", ">=", -0.3334)
corsac.expect("user.ratio", "<=", -0.3332)
corsac.expect("accuracy.joint_error_max_m", "<=", 0.001)
