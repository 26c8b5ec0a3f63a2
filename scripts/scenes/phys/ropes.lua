-- Ropes: one hangs as a catenary, one swings a ball of a thousand times its weight, a net of 40 x 40
-- catches a crate, and a thread tears when its load comes to 50 N.
local phys, scene, gfx = corsac.phys, corsac.scene, corsac.gfx
local n = 40
local chain, line, net, thread, ball, load, crate
local force, torn_at = 9.81, nil

function corsac.conf(t)
  t.steps = 900
end

local function body(x, y, z, size, mass, color, shape)
  return scene.spawn{ position = { x, y, z }, mesh = shape, color = color, body = { shape = shape,
    size = shape == "box" and { size, size, size } or nil, radius = shape == "sphere" and size or
    nil, density = shape == "box" and mass / size ^ 3 or mass / (4 / 3 * math.pi * size ^ 3) } }
    :getBody()
end

function corsac.load()
  chain = phys.newRope{ count = 101, from = { -4, 3, 0 }, to = { -1.5, 3, 0 }, damping = 2,
    drag = 0 }
  chain:hold(1, 1)
  chain:pin(1, 101, -2, 3, 0)
  ball = body(0.3, 1.2, 0, 0.15, 10, { 0.8, 0.3, 0.2 }, "sphere")
  line = phys.newRope{ count = 21, from = { 0, 3, 0 }, to = { 0.3, 1.35, 0 }, mass = 0.01 }
  line:hold(1, 1)
  line:hold(1, 21, ball)
  net = phys.newCloth{ columns = n, rows = n, position = { 1.2, 1.2, -1 }, across = { 2, 0, 0 },
    down = { 0, 0, 2 }, mass = 3, shear = 0.01 }
  for i = 1, n do
    net:hold(i, 1)
    net:hold(i, n)
    net:hold(1, i)
    net:hold(n, i)
  end
  crate = body(2.2, 2.5, 0, 0.4, 5, { 0.7, 0.5, 0.3 }, "box")
  load = body(4, 1.85, 0, 0.15, 1, { 0.3, 0.5, 0.8 }, "sphere")
  thread = phys.newRope{ count = 21, from = { 4, 3, 0 }, to = { 4, 2, 0 }, mass = 0.01,
    tearForce = 50 }
  thread:hold(1, 1)
  thread:hold(1, 21, load)
  gfx.setBackground(0.025, 0.03, 0.045)
  gfx.setAmbient(0.2, 0.22, 0.26)
  gfx.newLight{ type = "directional", direction = { -0.5, -1, -0.6 }, intensity = 2.8 }
  gfx.setCamera{ position = { 0.5, 2.6, 7.5 }, target = { 0.3, 1.6, 0 }, fov = 0.8, far = 200 }
end

function corsac.fixed()
  local _, y = chain:getPoint(1, 51)
  corsac.metrics.set("sag_m", 3 - y)
  if thread:getTorn() == 0 then
    force = force + 0.1
    load:applyForce(0, 9.81 - force, 0)
  elseif not torn_at then
    torn_at = force
    corsac.metrics.set("torn_at_n", force)
  end
  local _, most = line:getStretch()
  corsac.metrics.set("line_stretch", most)
  local _, height = crate:getPosition()
  corsac.metrics.set("crate_m", height)
end

function corsac.draw()
  for _, rope in ipairs{ chain, line, thread } do
    gfx.drawPath(rope:getPoints(), { color = { 0.9, 0.8, 0.6 }, width = 2 })
  end
  local p = net:getPoints()
  for r = 1, n do
    local across, down = {}, {}
    for c = 1, n do
      for k = 1, 3 do
        across[#across + 1] = p[3 * ((r - 1) * n + c - 1) + k]
        down[#down + 1] = p[3 * ((c - 1) * n + r - 1) + k]
      end
    end
    gfx.drawPath(across, { color = { 0.4, 0.7, 0.5 } })
    gfx.drawPath(down, { color = { 0.4, 0.7, 0.5 } })
  end
end

-- 2.5 m between points 2 m apart: 2 a sinh(1 / a) = 2.5, sag a (cosh(1 / a) - 1) = 0.6636 m.
corsac.expect("user.sag_m", ">=", 0.6586)
corsac.expect("user.sag_m", "<=", 0.6686)
corsac.expect("user.torn_at_n", ">=", 47.5)
corsac.expect("user.torn_at_n", "<=", 52.5)
corsac.expect("user.line_stretch", "<=", 0.005)
corsac.expect("user.crate_m", ">=", 0.5)
