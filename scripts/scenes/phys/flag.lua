-- A flag in a wind of 10 m/s that stops after eight seconds: it flies, then it hangs.
local phys, scene, gfx = corsac.phys, corsac.scene, corsac.gfx
local columns, rows = 30, 20
local flag, wind, steps, flown = nil, nil, 0, 0

function corsac.conf(t)
  t.steps = 1080
end

function corsac.load()
  scene.spawn{ position = { 0, 1.5, 0 }, mesh = "cylinder", color = { 0.6, 0.6, 0.6 },
    body = { type = "static", shape = "cylinder", radius = 0.03, height = 3 } }
  flag = phys.newCloth{ columns = columns, rows = rows, position = { 0.05, 2.9, 0 },
    across = { 1.5, 0, 0 }, down = { 0, -1, 0 }, mass = 0.25, bend = 1, damping = 0.5 }
  for r = 1, rows do
    flag:hold(1, r)
  end
  wind = phys.newField{ type = "wind", velocity = { 9, 0, 4 } }
  gfx.setBackground(0.1, 0.14, 0.22)
  gfx.setAmbient(0.3, 0.3, 0.33)
  gfx.newLight{ type = "directional", direction = { -0.5, -1, -0.6 }, intensity = 2.8 }
  gfx.setCamera{ position = { 0.8, 2.2, 3.4 }, target = { 0.6, 2.1, 0 }, fov = 0.8, far = 200 }
end

function corsac.fixed()
  steps = steps + 1
  local x, y, z = flag:getPoint(columns, rows)
  if steps > 240 and steps <= 480 then
    flown = flown + math.sqrt(x * x + z * z) / 240
    corsac.metrics.set("flown_m", flown)
  elseif steps == 481 then
    wind:destroy()
  end
  corsac.metrics.set("hangs_m", 2.9 - y)
  local _, most = flag:getStretch()
  corsac.metrics.set("stretch_most", most)
end

function corsac.draw()
  local p = flag:getPoints()
  for r = 1, rows do
    local line = {}
    for i = 3 * (r - 1) * columns + 1, 3 * r * columns do
      line[#line + 1] = p[i]
    end
    gfx.drawPath(line, { color = { 0.9, 0.3, 0.2 }, width = 3 })
  end
  for c = 1, columns do
    local line = {}
    for r = 1, rows do
      for k = 1, 3 do
        line[#line + 1] = p[3 * ((r - 1) * columns + c - 1) + k]
      end
    end
    gfx.drawPath(line, { color = { 0.95, 0.85, 0.3 } })
  end
end

corsac.expect("user.flown_m", ">=", 1.1)
corsac.expect("user.hangs_m", ">=", 1.5)
corsac.expect("user.stretch_most", "<=", 0.1)
