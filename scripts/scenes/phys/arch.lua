-- A round arch of eleven stones without mortar on two fixed springers: it carries itself, and a load
-- on its crown.
local phys, scene, gfx = corsac.phys, corsac.scene, corsac.gfx
local n, inner, outer, depth, stones = 11, 2, 2.5, 0.8, {}

function corsac.conf(t)
  t.steps = 600
end

-- The corners of stone k about its middle, and that middle.
local function stone(k)
  local corners, mx, my, points = {}, 0, 0, {}
  for _, angle in ipairs{ math.pi * k / n, math.pi * (k + 1) / n } do
    for _, radius in ipairs{ inner, outer } do
      local x, y = -radius * math.cos(angle), radius * math.sin(angle)
      table.insert(corners, { x, y })
      mx, my = mx + x / 4, my + y / 4
    end
  end
  for _, corner in ipairs(corners) do
    for side = -1, 1, 2 do
      for _, value in ipairs{ corner[1] - mx, corner[2] - my, side * depth / 2 } do
        table.insert(points, value)
      end
    end
  end
  return points, mx, my
end

function corsac.load()
  for k = 0, n - 1 do
    local points, x, y = stone(k)
    stones[k] = scene.spawn{ position = { x, y, 0 },
      body = { shape = "hull", points = points, density = 2400, friction = 0.7 } }
    scene.spawn{ parent = stones[k], mesh = "box", color = { 0.75, 0.68, 0.55 },
      scale = { outer - inner, math.pi * 2.1 / n, depth },
      rotation = { axis = { 0, 0, 1 }, angle = -math.pi * (k + 0.5) / n } }
  end
  for side = -1, 1, 2 do
    scene.spawn{ position = { side * 2.5, -0.5, 0 }, mesh = "box", color = { 0.42, 0.45, 0.52 },
      body = { type = "static", shape = "box", size = { 2, 1, 1 }, friction = 0.7 } }
  end
  scene.spawn{ position = { 0, outer + 0.25, 0 }, mesh = "box", color = { 0.9, 0.5, 0.3 },
    body = { shape = "box", size = { 0.5, 0.5, 0.5 }, density = 2400, friction = 0.7 } }
  gfx.setBackground(0.025, 0.03, 0.045)
  gfx.setAmbient(0.2, 0.22, 0.26)
  gfx.newLight{ type = "directional", direction = { -0.5, -1, -0.6 }, intensity = 2.8 }
  gfx.setCamera{ position = { 2, 2.5, 6.5 }, target = { 0, 1.2, 0 }, fov = 0.9, far = 200 }
end

local _, _, crown = stone((n - 1) / 2)
function corsac.fixed()
  local _, y = stones[(n - 1) / 2]:getPosition()
  corsac.metrics.set("crown_sag_m", crown - y)
  corsac.metrics.set("bodies", phys.getBodyCount())
end

corsac.expect("user.crown_sag_m", "<=", 0.01)
corsac.expect("user.crown_sag_m", ">=", -0.001)
corsac.expect("accuracy.penetration_max_m", "<=", 0.003)
