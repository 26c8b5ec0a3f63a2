-- A stack of capsules, crosswise in pairs: it stands.
local scene, gfx = corsac.scene, corsac.gfx
local layers, top = 8, nil

function corsac.conf(t)
  t.steps = 600
end

function corsac.load()
  scene.spawn{ position = { 0, -1, 0 }, mesh = "box", color = { 0.42, 0.45, 0.52 },
    body = { type = "static", shape = "box", size = { 200, 2, 200 }, friction = 0.5 } }
  for i = 0, layers - 1 do
    for k = -1, 1, 2 do
      local along = i % 2 == 0
      top = scene.spawn{ position = { along and 0.5 * k or 0, 0.25 + 0.5 * i, along and 0 or 0.5 * k },
        rotation = { axis = along and { 1, 0, 0 } or { 0, 0, 1 }, angle = math.pi / 2 },
        mesh = "capsule", color = { 0.9, 0.3 + 0.07 * i, 0.3 },
        body = { shape = "capsule", radius = 0.25, height = 1.5 } }
    end
  end
  gfx.setBackground(0.025, 0.03, 0.045)
  gfx.setAmbient(0.2, 0.22, 0.26)
  gfx.newLight{ type = "directional", direction = { -0.5, -1, -0.6 }, intensity = 2.8 }
  gfx.setCamera{ position = { 5, 4, 6 }, target = { 0, 2, 0 }, fov = 0.9, far = 200 }
end

function corsac.fixed()
  local _, y = top:getPosition()
  corsac.metrics.set("sag_m", 0.5 * layers - 0.25 - y)
end

corsac.expect("user.sag_m", "<=", 0.003)
corsac.expect("user.sag_m", ">=", 0)
