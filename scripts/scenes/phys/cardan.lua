-- Two shafts at an angle beta with a universal joint between them: at a steady drive the output
-- runs between cos beta and 1 / cos beta times as fast.
local phys, scene, gfx = corsac.phys, corsac.scene, corsac.gfx
local beta = corsac.param("beta", 0.5)
local ox, oy = math.cos(beta), math.sin(beta)
local driven, drive, least, most, steps = nil, nil, math.huge, 0, 0

function corsac.conf(t)
  t.steps = 480
end

function corsac.load()
  local function shaft(x, y, angle, color)
    return scene.spawn{ position = { x, y, 0 }, mesh = "box", color = color,
      rotation = { axis = { 0, 0, 1 }, angle = angle },
      body = { shape = "box", size = { 0.9, 0.2, 0.2 } } }:getBody()
  end
  drive = shaft(-0.5, 0, 0, { 0.9, 0.5, 0.3 })
  driven = shaft(0.5 * ox, 0.5 * oy, beta, { 0.3, 0.6, 0.9 })
  phys.newJoint{ type = "revolute", b = drive, anchor = { -1, 0, 0 }, axis = { 1, 0, 0 },
    motorSpeed = 2, motorMax = 10000 }
  phys.newJoint{ type = "revolute", b = driven, anchor = { ox, oy, 0 }, axis = { ox, oy, 0 } }
  phys.newJoint{ type = "universal", a = drive, b = driven, anchor = { 0, 0, 0 },
    axis = { 0, 0, 1 }, axisB = { -oy, ox, 0 } }
  gfx.setBackground(0.025, 0.03, 0.045)
  gfx.setAmbient(0.2, 0.22, 0.26)
  gfx.newLight{ type = "directional", direction = { -0.5, -1, -0.6 }, intensity = 2.8 }
  gfx.setCamera{ position = { 0.2, 0.8, 2.6 }, target = { 0, 0.1, 0 }, fov = 0.9, far = 200 }
end

function corsac.fixed()
  steps = steps + 1
  if steps > 60 then
    local x, y = driven:getAngularVelocity()
    local ratio = (x * ox + y * oy) / (drive:getAngularVelocity())
    least, most = math.min(least, ratio), math.max(most, ratio)
    corsac.metrics.set("least_error", math.abs(least - math.cos(beta)))
    corsac.metrics.set("most_error", math.abs(most - 1 / math.cos(beta)))
  end
end

corsac.expect("user.least_error", "<=", 0.005)
corsac.expect("user.most_error", "<=", 0.005)
corsac.expect("accuracy.joint_error_max_m", "<=", 0.001)
