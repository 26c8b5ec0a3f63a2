-- Balls dropped from 5 m with restitution 0, 0.25, 0.5, 0.75 and 1: each bounces to its square.
local scene, gfx = corsac.scene, corsac.gfx
local balls, top, down = {}, {}, {}

function corsac.conf(t)
  t.steps = 170
end

function corsac.load()
  scene.spawn{ position = { 0, -1, 0 }, mesh = "box", color = { 0.42, 0.45, 0.52 },
    body = { type = "static", shape = "box", size = { 200, 2, 200 }, friction = 0.5 } }
  for i = 0, 4 do
    balls[i] = scene.spawn{ position = { 2 * i - 4, 5.5, 0 }, mesh = "sphere",
      color = { 0.9, 0.2 + 0.17 * i, 0.3 },
      body = { shape = "sphere", radius = 0.5, restitution = i / 4 } }
    top[i] = 0
  end
  gfx.setBackground(0.025, 0.03, 0.045)
  gfx.setAmbient(0.2, 0.22, 0.26)
  gfx.newLight{ type = "directional", direction = { -0.5, -1, -0.6 }, intensity = 2.8 }
  gfx.setCamera{ position = { 0, 4, 12 }, target = { 0, 2.5, 0 }, fov = 0.9, far = 200 }
end

function corsac.fixed()
  local worst = 0
  for i = 0, 4 do
    local _, y = balls[i]:getPosition()
    down[i] = down[i] or y < 0.6
    local _, vy = balls[i]:getBody():getVelocity()
    if down[i] and (vy > 0 or top[i] > 0) and corsac.getStep() > 62 then
      top[i] = math.max(top[i], y - 0.5)
    end
    worst = math.max(worst, math.abs(top[i] / 5 - (i / 4) * (i / 4)))
  end
  corsac.metrics.set("worst", worst)
end

corsac.expect("user.worst", "<=", 0.01)
