-- A cloth of 40 x 40 hangs by two corners, another falls over a ball: neither stretches by more
-- than its bound, none gets into the ball, and what lies still falls asleep.
local phys, scene, gfx = corsac.phys, corsac.scene, corsac.gfx
local n = corsac.param("n", 40)
local curtain, cover

function corsac.conf(t)
  t.steps = 600
end

function corsac.load()
  scene.spawn{ position = { 0, -0.1, 0 }, mesh = "box", color = { 0.3, 0.33, 0.3 },
    body = { type = "static", shape = "box", size = { 12, 0.2, 8 } } }
  scene.spawn{ position = { 1.5, 0.6, 0 }, mesh = "sphere", color = { 0.75, 0.35, 0.25 },
    body = { type = "static", shape = "sphere", radius = 0.6 } }
  curtain = phys.newCloth{ columns = n, rows = n, position = { -2.6, 2.4, -0.7 },
    across = { 2, 0, 0 }, down = { 0, -0.3, 2 } }
  curtain:hold(1, 1)
  curtain:hold(n, 1)
  cover = phys.newCloth{ columns = n, rows = n, position = { 0.5, 1.5, -1 }, across = { 2, 0, 0 },
    down = { 0, 0, 2 } }
  gfx.setBackground(0.025, 0.03, 0.045)
  gfx.setAmbient(0.2, 0.22, 0.26)
  gfx.newLight{ type = "directional", direction = { -0.5, -1, -0.6 }, intensity = 2.8 }
  gfx.setCamera{ position = { 0, 2.6, 6 }, target = { 0, 1, 0 }, fov = 0.8, far = 200 }
end

function corsac.fixed()
  local mean, most = curtain:getStretch()
  corsac.metrics.set("curtain_mean", mean)
  corsac.metrics.set("curtain_most", most)
  local points, deepest = cover:getPoints(), 0 -- garbage: a table of points a step
  for i = 1, #points, 3 do
    local x, y, z = points[i] - 1.5, points[i + 1] - 0.6, points[i + 2]
    deepest = math.max(deepest, 0.6 - math.sqrt(x * x + y * y + z * z))
  end
  corsac.metrics.set("depth_m", deepest)
  mean = cover:getStretch()
  corsac.metrics.set("cover_mean", mean)
end

local function draw(cloth, color)
  local p = cloth:getPoints()
  for r = 1, n do
    local across, down = {}, {}
    for c = 1, n do
      for k = 1, 3 do
        across[#across + 1] = p[3 * ((r - 1) * n + c - 1) + k]
        down[#down + 1] = p[3 * ((c - 1) * n + r - 1) + k]
      end
    end
    gfx.drawPath(across, { color = color })
    gfx.drawPath(down, { color = color })
  end
end

function corsac.draw()
  draw(curtain, { 0.3, 0.6, 0.9 })
  draw(cover, { 0.9, 0.8, 0.5 })
end

corsac.expect("user.curtain_mean", "<=", 0.002)
corsac.expect("user.curtain_most", "<=", 0.03)
corsac.expect("user.cover_mean", "<=", 0.01)
corsac.expect("user.depth_m", "<=", 0)
