-- Thin plates of 4 mm, 250 times as wide, dropped one on another: they lie flat, in their order.
local scene, gfx = corsac.scene, corsac.gfx
local n, plates = 16, {}

function corsac.conf(t)
  t.steps = 600
end

function corsac.load()
  scene.spawn{ position = { 0, -1, 0 }, mesh = "box", color = { 0.42, 0.45, 0.52 },
    body = { type = "static", shape = "box", size = { 200, 2, 200 }, friction = 0.5 } }
  for i = 1, n do
    plates[i] = scene.spawn{ mesh = "box", color = { 0.9, 0.3 + 0.04 * i, 0.3 },
      position = { 0.1 * math.random(), 0.05 * i, 0.1 * math.random() },
      rotation = { axis = { 0, 1, 0 }, angle = math.random() },
      body = { shape = "box", size = { 1, 0.004, 1 } } }
  end
  gfx.setBackground(0.025, 0.03, 0.045)
  gfx.setAmbient(0.2, 0.22, 0.26)
  gfx.newLight{ type = "directional", direction = { -0.5, -1, -0.6 }, intensity = 2.8 }
  gfx.setCamera{ position = { 1.2, 0.9, 1.4 }, target = { 0, 0.1, 0 }, fov = 0.9, far = 200 }
end

function corsac.fixed()
  local swapped, below = 0, -1
  for _, plate in ipairs(plates) do
    local _, y = plate:getPosition()
    swapped = swapped + (y < below and 1 or 0)
    below = y
  end
  corsac.metrics.set("swapped", swapped)
  corsac.metrics.set("top_m", below)
end

-- The pile is as high as its plates but for what contacts give.
corsac.expect("user.swapped", "==", 0)
corsac.expect("user.top_m", ">=", 0.7 * n * 0.004)
corsac.expect("user.top_m", "<=", n * 0.004)
corsac.expect("accuracy.nan", "==", 0)
