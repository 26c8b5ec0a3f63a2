-- A disc on a stick, held at the end of the stick: spun at 60 rad/s it goes round, at the rate
-- m g d / (I w) of the steady precession of a top that lies level.
local phys, scene, gfx = corsac.phys, corsac.scene, corsac.gfx
local arm, radius, spin, disc = 0.5, 0.5, corsac.param("spin", 60), nil
local rate = 9.81 * arm / (0.5 * radius * radius * spin)

function corsac.conf(t)
  t.steps = 600
end

function corsac.load()
  disc = scene.spawn{ position = { arm, 0, 0 }, mesh = "cylinder", color = { 0.9, 0.6, 0.3 },
    rotation = { axis = { 0, 0, 1 }, angle = -math.pi / 2 },
    body = { shape = "cylinder", radius = radius, height = 0.1, velocity = { 0, 0, -rate * arm },
      angularVelocity = { spin, rate, 0 } } }
  phys.newJoint{ type = "ball", b = disc:getBody(), anchor = { 0, 0, 0 } }
  gfx.setBackground(0.025, 0.03, 0.045)
  gfx.setAmbient(0.2, 0.22, 0.26)
  gfx.newLight{ type = "directional", direction = { -0.5, -1, -0.6 }, intensity = 2.8 }
  gfx.setCamera{ position = { 1.2, 1.2, 2 }, target = { 0, 0, 0 }, fov = 0.9, far = 200 }
end

local angle, before, steps = 0, 0, 0
function corsac.fixed(dt)
  local x, y, z = disc:getPosition()
  local now = math.atan2(-z, x)
  angle = angle + (now - before + math.pi) % (2 * math.pi) - math.pi
  before, steps = now, steps + 1
  corsac.metrics.set("rate_over_closed_form", steps > 1 and angle / ((steps - 1) * dt) / rate or 1)
  corsac.metrics.set("droop_m", math.abs(y))
end

corsac.expect("user.rate_over_closed_form", ">=", 0.99)
corsac.expect("user.rate_over_closed_form", "<=", 1.01)
corsac.expect("user.droop_m", "<=", 0.006)
corsac.expect("accuracy.joint_error_max_m", "<=", 0.001)
