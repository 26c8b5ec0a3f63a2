-- A row of dominoes; the first is pushed, the last one falls.
local scene, gfx = corsac.scene, corsac.gfx
local n = corsac.param("n", 24)
local first, last

function corsac.conf(t)
  t.steps = 600
end

function corsac.load()
  scene.spawn{ position = { 0, -1, 0 }, mesh = "box", color = { 0.42, 0.45, 0.52 },
    body = { type = "static", shape = "box", size = { 200, 2, 200 }, friction = 0.5 } }
  for i = 1, n do
    last = scene.spawn{ position = { 0.5 * i - n / 4, 0.5, 0 }, mesh = "box",
      color = { 0.9, 0.35 + 0.5 * i / n, 0.3 },
      body = { shape = "box", size = { 0.12, 1, 0.5 }, friction = 0.5 } }
    first = first or last
  end
  first:getBody():applyImpulse(40, 0, 0, 0.5 - n / 4, 0.95, 0)
  gfx.setBackground(0.025, 0.03, 0.045)
  gfx.setAmbient(0.2, 0.22, 0.26)
  gfx.newLight{ type = "directional", direction = { -0.5, -1, -0.6 }, intensity = 2.8 }
  gfx.setCamera{ position = { 0, 3, 9 }, target = { 0, 0.5, 0 }, fov = 0.9, far = 200 }
end

function corsac.fixed()
  local _, y = last:getPosition()
  corsac.metrics.set("last_y", y)
end

corsac.expect("user.last_y", "<=", 0.35)
corsac.expect("accuracy.nan", "==", 0)
