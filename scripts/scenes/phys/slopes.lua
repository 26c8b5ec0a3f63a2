-- Scene S11: a block on slopes of 5 to 40 degrees with friction 0.5. Below 26.57 degrees it stays,
-- above it slides as g (sin a - 0.5 cos a) says; a ball rolls without sliding at 5/7 g sin a.
local scene, gfx = corsac.scene, corsac.gfx
local slopes, seconds = { 5, 15, 20, 25, 26, 27, 30, 40 }, 3
local blocks, steps = {}, 0

function corsac.conf(t)
  t.steps = 60 * seconds
end

-- Along and away from slope number i.
local function directions(angle)
  local s, c = math.sin(angle), math.cos(angle)
  return c, -s, s, c
end

local function on_slope(i, degrees, kind)
  local angle = math.rad(degrees)
  local ax, ay, nx, ny = directions(angle)
  local turn = { axis = { 0, 0, 1 }, angle = -angle }
  scene.spawn{ position = { 40 * ax - nx, 40 * ay - ny, 3 * i }, rotation = turn, mesh = "box",
    color = { 0.42, 0.45, 0.52 },
    body = { type = "static", shape = "box", size = { 100, 2, 2 }, friction = 0.5 } }
  local h = kind == "ball" and 0.5 or 0.25
  local body = kind == "ball" and { shape = "sphere", radius = 0.5, friction = 0.5 }
    or { shape = "box", size = { 1, 0.5, 1 }, friction = 0.5 }
  local thing = scene.spawn{ position = { h * nx, h * ny, 3 * i }, rotation = turn,
    mesh = kind == "ball" and "sphere" or "box", color = { 0.9, 0.5, 0.3 }, body = body }
  table.insert(blocks, { thing = thing, angle = angle, h = h, kind = kind })
end

function corsac.load()
  for i, degrees in ipairs(slopes) do
    on_slope(i, degrees, "block")
  end
  for i, degrees in ipairs{ 10, 20, 40 } do
    on_slope(#slopes + i, degrees, "ball")
  end
  gfx.setBackground(0.025, 0.03, 0.045)
  gfx.setAmbient(0.2, 0.22, 0.26)
  gfx.newLight{ type = "directional", direction = { -0.5, -1, -0.6 }, intensity = 2.8 }
  gfx.setCamera{ position = { -12, 10, 16 }, target = { 6, -4, 14 }, fov = 0.9, far = 200 }
end

function corsac.fixed(dt)
  steps = steps + 1
  local creep, worst, t = 0, 0, (steps - 1) * dt
  for _, block in ipairs(blocks) do
    local ax, ay, nx, ny = directions(block.angle)
    local x, y = block.thing:getPosition()
    local way = (x - block.h * nx) * ax + (y - block.h * ny) * ay
    local a = 9.81 * (math.sin(block.angle) - 0.5 * math.cos(block.angle))
    a = block.kind == "ball" and 5 / 7 * 9.81 * math.sin(block.angle) or a
    if a <= 0 then
      creep = math.max(creep, math.abs(way))
    elseif t > 1 then
      worst = math.max(worst, math.abs(way / (0.5 * a * t * t) - 1))
    end
  end
  corsac.metrics.set("creep_m", creep)
  corsac.metrics.set("slide_error", worst)
end

corsac.expect("user.creep_m", "<=", 0.001)
corsac.expect("user.slide_error", "<=", 0.02)
