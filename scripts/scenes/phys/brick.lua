-- The tumbling brick: spun about its middle axis it turns over again and again, and keeps its energy.
local phys, scene, gfx = corsac.phys, corsac.scene, corsac.gfx
local brick, flips, sign = nil, 0, 1

function corsac.conf(t)
  t.steps = 3600
end

function corsac.load()
  phys.setGravity(0, 0, 0)
  brick = scene.spawn{ mesh = "box", color = { 0.9, 0.5, 0.3 },
    body = { shape = "box", size = { 1, 0.6, 0.2 }, angularVelocity = { 0.01, 5, 0.01 } } }
  gfx.setBackground(0.025, 0.03, 0.045)
  gfx.setAmbient(0.2, 0.22, 0.26)
  gfx.newLight{ type = "directional", direction = { -0.5, -1, -0.6 }, intensity = 2.8 }
  gfx.setCamera{ position = { 1, 1, 3 }, target = { 0, 0, 0 }, fov = 0.9, far = 200 }
end

function corsac.fixed()
  local x, y, z, w = brick:getRotation()
  local wx, wy, wz = brick:getBody():getAngularVelocity()
  -- The spin along the brick's own y axis.
  local along = 2 * (x * y - z * w) * wx + (1 - 2 * (x * x + z * z)) * wy + 2 * (y * z + x * w) * wz
  if along * sign < -0.5 then
    flips, sign = flips + 1, -sign
  end
  corsac.metrics.set("flips", flips)
end

corsac.expect("user.flips", ">=", 8)
corsac.expect("accuracy.energy_drift", "<=", 0.001)
