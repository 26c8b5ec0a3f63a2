-- A stack of logs: capsules between two posts, six, five, four, ... to a row.
local scene, gfx = corsac.scene, corsac.gfx
local top

function corsac.conf(t)
  t.steps = 600
end

function corsac.load()
  scene.spawn{ position = { 0, -1, 0 }, mesh = "box", color = { 0.42, 0.45, 0.52 },
    body = { type = "static", shape = "box", size = { 200, 2, 200 }, friction = 0.5 } }
  for side = -1, 1, 2 do
    scene.spawn{ position = { side * 3.25, 1, 0 }, mesh = "box", color = { 0.5, 0.5, 0.55 },
      body = { type = "static", shape = "box", size = { 0.5, 2, 4 } } }
  end
  local step = 0.5 * math.sqrt(3)
  for row = 0, 5 do
    for i = 0, 5 - row do
      top = scene.spawn{ position = { i - (5 - row) / 2, 0.5 + step * row, 0 },
        rotation = { axis = { 1, 0, 0 }, angle = math.pi / 2 }, mesh = "capsule",
        color = { 0.6, 0.42, 0.25 }, body = { shape = "capsule", radius = 0.5, height = 3 } }
    end
  end
  gfx.setBackground(0.025, 0.03, 0.045)
  gfx.setAmbient(0.2, 0.22, 0.26)
  gfx.newLight{ type = "directional", direction = { -0.5, -1, -0.6 }, intensity = 2.8 }
  gfx.setCamera{ position = { 5, 5, 9 }, target = { 0, 2, 0 }, fov = 0.9, far = 200 }
end

function corsac.fixed()
  local _, y = top:getPosition()
  corsac.metrics.set("sag_m", 0.5 + 5 * 0.5 * math.sqrt(3) - y)
end

corsac.expect("user.sag_m", "<=", 0.05)
corsac.expect("accuracy.nan", "==", 0)
