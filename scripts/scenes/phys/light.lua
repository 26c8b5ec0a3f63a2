-- Light and heavy in turns, a thousand to one, and the light one on top of the heavy: neither
-- pushes the other into the ground.
local scene, gfx = corsac.scene, corsac.gfx
local tops = {}

function corsac.conf(t)
  t.steps = 600
end

local function stack(x, densities)
  local top
  for i, density in ipairs(densities) do
    top = scene.spawn{ position = { x, i - 0.5, 0 }, mesh = "box",
      color = density > 1000 and { 0.35, 0.35, 0.4 } or { 0.9, 0.6, 0.3 },
      body = { shape = "box", size = { 1, 1, 1 }, density = density } }
  end
  table.insert(tops, { thing = top, y = #densities - 0.5 })
end

function corsac.load()
  scene.spawn{ position = { 0, -1, 0 }, mesh = "box", color = { 0.42, 0.45, 0.52 },
    body = { type = "static", shape = "box", size = { 200, 2, 200 }, friction = 0.5 } }
  stack(-3, { 1e6, 1000 })
  stack(0, { 1e6, 1000, 1e6 })
  stack(3, { 1000, 1e6, 1000, 1e6 })
  gfx.setBackground(0.025, 0.03, 0.045)
  gfx.setAmbient(0.2, 0.22, 0.26)
  gfx.newLight{ type = "directional", direction = { -0.5, -1, -0.6 }, intensity = 2.8 }
  gfx.setCamera{ position = { 2, 4, 9 }, target = { 0, 1.5, 0 }, fov = 0.9, far = 200 }
end

function corsac.fixed()
  for i, top in ipairs(tops) do
    local _, y = top.thing:getPosition()
    corsac.metrics.set("sag_" .. i, math.abs(top.y - y))
  end
end

corsac.expect("user.sag_1", "<=", 0.001)
corsac.expect("user.sag_2", "<=", 0.025)
corsac.expect("user.sag_3", "<=", 0.05)
