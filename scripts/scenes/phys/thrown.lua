-- Scene S10: a thrown ball follows its parabola, a pendulum keeps its height.
local phys, scene, gfx = corsac.phys, corsac.scene, corsac.gfx
local ball, bob, steps, off, top = nil, nil, 0, 0, -1

function corsac.conf(t)
  t.steps = 300
end

function corsac.load()
  ball = scene.spawn{ mesh = "sphere", color = { 0.9, 0.5, 0.3 },
    body = { shape = "sphere", radius = 0.1, velocity = { 10, 20, 0 } } }
  bob = scene.spawn{ position = { -1, 0, 3 }, mesh = "sphere", color = { 0.3, 0.6, 0.9 },
    body = { shape = "sphere", radius = 0.1 } }
  phys.newJoint{ type = "ball", b = bob:getBody(), anchor = { 0, 0, 3 } }
  gfx.setBackground(0.025, 0.03, 0.045)
  gfx.setAmbient(0.2, 0.22, 0.26)
  gfx.newLight{ type = "directional", direction = { -0.5, -1, -0.6 }, intensity = 2.8 }
  gfx.setCamera{ position = { 0, 1, 9 }, target = { 0, 0, 0 }, fov = 0.9, far = 200 }
end

function corsac.fixed(dt)
  local t = steps * dt
  steps = steps + 1
  local x, y = ball:getPosition()
  off = math.max(off, math.abs(x - 10 * t), math.abs(y - 20 * t + 0.5 * 9.81 * t * t))
  corsac.metrics.set("off_parabola_m", off)
  local _, height = bob:getPosition()
  top = t > 2 and math.max(top, height) or top
  corsac.metrics.set("swing_lost_m", t > 2 and -top or 0)
end

corsac.expect("user.off_parabola_m", "<=", 0.001)
corsac.expect("user.swing_lost_m", "<=", 0.01)
corsac.expect("user.swing_lost_m", ">=", -0.001)
