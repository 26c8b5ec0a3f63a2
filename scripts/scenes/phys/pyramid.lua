-- Scene S2: a pyramid of cubes that touch sideways. n: cubes in the bottom row.
local scene, gfx = corsac.scene, corsac.gfx
local n, top = corsac.param("n", 20), nil

function corsac.conf(t)
  t.steps = 480
end

function corsac.load()
  scene.spawn{ position = { 0, -1, 0 }, mesh = "box", color = { 0.42, 0.45, 0.52 },
    body = { type = "static", shape = "box", size = { 200, 2, 200 }, friction = 0.5 } }
  for i = 0, n - 1 do
    for j = 0, n - i - 1 do
      top = scene.spawn{ position = { j - (n - i - 1) / 2, 0.5 + i, 0 }, mesh = "box",
        color = { 0.9, 0.3 + 0.5 * i / n, 0.3 }, body = { shape = "box", size = { 1, 1, 1 } } }
    end
  end
  gfx.setBackground(0.025, 0.03, 0.045)
  gfx.setAmbient(0.2, 0.22, 0.26)
  gfx.newLight{ type = "directional", direction = { -0.5, -1, -0.6 }, intensity = 2.8 }
  gfx.setCamera{ position = { 0, 0.6 * n, 1.5 * n }, target = { 0, 0.4 * n, 0 }, fov = 0.9, far = 200 }
end

function corsac.fixed()
  local _, y = top:getPosition()
  corsac.metrics.set("sag_m", n - 0.5 - y)
end

corsac.expect("user.sag_m", "<=", 0.005)
corsac.expect("user.sag_m", ">=", -0.001)
corsac.expect("accuracy.penetration_max_m", "<=", 0.002)
