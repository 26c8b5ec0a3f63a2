-- A tower of blocks, three a layer, crosswise; after a second every other layer loses its middle
-- block, and it stands on.
local scene, gfx = corsac.scene, corsac.gfx
local layers, middle, top, steps = 12, {}, nil, 0

function corsac.conf(t)
  t.steps = 600
end

function corsac.load()
  scene.spawn{ position = { 0, -1, 0 }, mesh = "box", color = { 0.42, 0.45, 0.52 },
    body = { type = "static", shape = "box", size = { 200, 2, 200 }, friction = 0.5 } }
  for i = 0, layers - 1 do
    for k = -1, 1 do
      local along = i % 2 == 0
      local block = scene.spawn{ mesh = "box", color = { 0.85, 0.7 - 0.1 * k, 0.45 },
        position = { along and 0.25 * k or 0, 0.075 + 0.15 * i, along and 0 or 0.25 * k },
        body = { shape = "box", size = along and { 0.25, 0.15, 0.75 } or { 0.75, 0.15, 0.25 } } }
      if k == 0 and i % 2 == 1 and i < layers - 1 then
        table.insert(middle, block)
      end
      top = block
    end
  end
  gfx.setBackground(0.025, 0.03, 0.045)
  gfx.setAmbient(0.2, 0.22, 0.26)
  gfx.newLight{ type = "directional", direction = { -0.5, -1, -0.6 }, intensity = 2.8 }
  gfx.setCamera{ position = { 2.2, 1.6, 2.6 }, target = { 0, 0.9, 0 }, fov = 0.9, far = 200 }
end

function corsac.fixed()
  steps = steps + 1
  if steps == 60 then
    for _, block in ipairs(middle) do
      block:destroy()
    end
  end
  local x, y, z = top:getPosition()
  corsac.metrics.set("sag_m", 0.15 * layers - 0.075 - y)
  corsac.metrics.set("drift_m", math.sqrt(x * x + (z - 0.25) ^ 2))
end

corsac.expect("user.sag_m", "<=", 0.005)
corsac.expect("user.drift_m", "<=", 0.005)
