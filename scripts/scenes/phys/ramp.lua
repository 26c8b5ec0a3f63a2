-- Two blocks on a slope of atan 0.5: the one with friction 0.52 stays, the one with 0.48 slides. The
-- slope is made by tilting gravity.
local phys, scene, gfx = corsac.phys, corsac.scene, corsac.gfx
local stays, slides

function corsac.conf(t)
  t.steps = 300
end

function corsac.load()
  local a = math.atan(0.5)
  phys.setGravity(9.81 * math.sin(a), -9.81 * math.cos(a), 0)
  scene.spawn{ position = { 0, -1, 0 }, mesh = "box", color = { 0.42, 0.45, 0.52 },
    body = { type = "static", shape = "box", size = { 200, 2, 200 }, friction = 1 } }
  local function block(z, friction)
    return scene.spawn{ position = { 0, 0.25, z }, mesh = "box", color = { 0.9, friction, 0.3 },
      body = { shape = "box", size = { 1, 0.5, 1 }, friction = friction * friction } }
  end
  stays, slides = block(-1, 0.52), block(1, 0.48)
  gfx.setBackground(0.025, 0.03, 0.045)
  gfx.setAmbient(0.2, 0.22, 0.26)
  gfx.newLight{ type = "directional", direction = { -0.5, -1, -0.6 }, intensity = 2.8 }
  gfx.setCamera{ position = { 4, 4, 9 }, target = { 2, 0, 0 }, fov = 0.9, far = 200 }
end

function corsac.fixed()
  corsac.metrics.set("stayed_m", (stays:getPosition()))
  corsac.metrics.set("slid_m", (slides:getPosition()))
end

-- Pairs mix friction by the square root of the product, and the floor has 1.
corsac.expect("user.stayed_m", "<=", 0.002)
corsac.expect("user.slid_m", ">=", 0.9)
