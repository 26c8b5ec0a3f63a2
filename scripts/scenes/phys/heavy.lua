-- A heavy cube on light ones, with the load increasing from left to right. ratio: of the heaviest.
local scene, gfx = corsac.scene, corsac.gfx
local ratio = corsac.param("ratio", 1000)
local tops = {}

function corsac.conf(t)
  t.steps = 600
end

function corsac.load()
  scene.spawn{ position = { 0, -1, 0 }, mesh = "box", color = { 0.42, 0.45, 0.52 },
    body = { type = "static", shape = "box", size = { 200, 2, 200 }, friction = 0.5 } }
  for i, load in ipairs{ 1, 10, 100, ratio } do
    local x = 3 * i - 7.5
    scene.spawn{ position = { x, 0.5, 0 }, mesh = "box", color = { 0.85, 0.8, 0.6 },
      body = { shape = "box", size = { 1, 1, 1 }, density = 1000 } }
    tops[i] = scene.spawn{ position = { x, 1.5, 0 }, mesh = "box", color = { 0.3, 0.32, 0.36 },
      body = { shape = "box", size = { 1, 1, 1 }, density = 1000 * load } }
  end
  gfx.setBackground(0.025, 0.03, 0.045)
  gfx.setAmbient(0.2, 0.22, 0.26)
  gfx.newLight{ type = "directional", direction = { -0.5, -1, -0.6 }, intensity = 2.8 }
  gfx.setCamera{ position = { 0, 3, 11 }, target = { 0, 1, 0 }, fov = 0.9, far = 200 }
end

function corsac.fixed()
  local worst = 0
  for _, top in ipairs(tops) do
    local _, y = top:getPosition()
    worst = math.max(worst, 1.5 - y)
  end
  corsac.metrics.set("sag_m", worst)
end

corsac.expect("user.sag_m", "<=", 0.025)
corsac.expect("user.sag_m", ">=", -0.001)
