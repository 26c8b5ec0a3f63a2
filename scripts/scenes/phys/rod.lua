-- A rod of 4 m on a hinge turns at 100 rad/s: its end goes 3.3 m a step. A post of 2 cm in its way
-- stops it.
local phys, scene, gfx = corsac.phys, corsac.scene, corsac.gfx
local hinge

function corsac.conf(t)
  t.steps = 120
end

function corsac.load()
  phys.setGravity(0, 0, 0)
  local rod = scene.spawn{ mesh = "box", color = { 0.9, 0.5, 0.3 },
    body = { shape = "box", size = { 4, 0.1, 0.1 }, density = 2700, angularVelocity = { 0, 100, 0 } } }
  hinge = phys.newJoint{ type = "revolute", b = rod:getBody(), anchor = { 0, 0, 0 },
    axis = { 0, 1, 0 } }
  scene.spawn{ position = { 0, 0, 1.8 }, mesh = "cylinder", color = { 0.42, 0.45, 0.52 },
    body = { type = "static", shape = "cylinder", radius = 0.01, height = 1 } }
  gfx.setBackground(0.025, 0.03, 0.045)
  gfx.setAmbient(0.2, 0.22, 0.26)
  gfx.newLight{ type = "directional", direction = { -0.5, -1, -0.6 }, intensity = 2.8 }
  gfx.setCamera{ position = { 0, 6, 5 }, target = { 0, 0, 0 }, fov = 0.9, far = 200 }
end

-- The rod starts along x and meets the post after a quarter turn, with one end or the other.
local most, least = 0, 0
function corsac.fixed()
  local angle = hinge:getValue()
  most, least = math.max(most, angle), math.min(least, angle)
  corsac.metrics.set("furthest_rad", math.max(most, -least))
end

corsac.expect("user.furthest_rad", ">=", 1.4)
corsac.expect("user.furthest_rad", "<=", math.pi / 2)
