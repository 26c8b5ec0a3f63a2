-- Ground, walls, plants and water: what never moves.
local layout = require("layout")
local scene, gfx, anim = corsac.scene, corsac.gfx, corsac.anim
local garden = {}

function garden.model(name)
  return anim.loadModel("models/" .. name .. ".cmodel")
end

-- Shows a model, turned about +Y.
function garden.put(name, x, y, z, turn, scale, color)
  return scene.spawn{ model = garden.model(name), position = { x, y, z }, scale = scale or 1,
    rotation = { axis = { 0, 1, 0 }, angle = turn or 0 }, color = color }
end

-- Fills the longer side of a box with copies of a model that is `width` long.
local function along(box, name, width, scale)
  local size, p = box.size, box.position
  local turned = size[3] > size[1]
  local length = turned and size[3] or size[1]
  local count = math.max(1, math.floor(length / (width * scale) + 0.5))
  local y = p[2] - size[2] / 2
  for i = 1, count do
    local at = (i - 0.5) * length / count - length / 2
    local turn = (turned and math.pi / 2 or 0) + (i % 2) * math.pi
    local e = garden.put(name, turned and p[1] or p[1] + at, y, turned and p[3] + at or p[3], turn)
    e:setScale(length / count / width, scale, scale)
  end
end

local shows = {
  wall = function(box) along(box, "wall", 2, 1.45) end,
  hedge = function(box) along(box, "hedge", 1, 1.1) end,
}

local function boxes()
  for _, box in ipairs(layout.boxes) do
    scene.spawn{ position = box.position, tags = { box.show or "ground" },
      body = { type = "static", shape = "box", size = box.size, layer = "world", friction = 0.8 } }
    if box.show then shows[box.show](box) end
  end
end

local function water()
  local material = gfx.newMaterial{ baseColor = { 0.01, 0.025, 0.035 }, roughness = 0.12 }
  scene.spawn{ mesh = "plane", position = { 0, -1.15, -2.3 }, scale = 22, material = material }
  for i = -10, 9 do
    garden.put("cliff", i + 0.5, 0.9, 2, 0, 1):setScale(0.5, 1, 1)
    garden.put("cliff", i + 0.5, 0.9, -7, math.pi, 1):setScale(0.5, 1, 1)
    if i >= -9 and i < 9 then garden.put("cliff", i + 0.5, 0.9, 10, 0, 1):setScale(0.5, 0.5, 0.6) end
  end
  for i = 1, 14 do
    garden.put("lily", 16 * math.random() - 8, -1.14, 7 * math.random() - 6, 6 * math.random(), 0.7 + math.random())
  end
end

-- Small plants by the way, thick at the walls and thin on the path.
local function meadow()
  local fields = { { -8.5, 8.5, 10.6, 24.4, 0, 110 }, { -8.5, 8.5, 2.9, 9.4, 0.9, 50 },
    { -10.5, 10.5, -24.5, -8, 0.9, 120 }, { -8.5, 8.5, -41.5, -25.8, 0.9, 130 } }
  local kinds = { "grass", "grass", "grass", "grass", "grass", "flower", "flower", "mushroom" }
  for _, f in ipairs(fields) do
    for _ = 1, f[6] do
      local x, z = f[1] + (f[2] - f[1]) * math.random(), f[3] + (f[4] - f[3]) * math.random()
      if math.abs(x) > 1.6 then
        garden.put(kinds[math.random(#kinds)], x, f[5], z, 6.2 * math.random(), 0.8 + 0.9 * math.random())
      end
    end
  end
end

local function outside()
  for i = 1, 34 do
    local side = i % 2 * 2 - 1
    local z = 27 - 2.15 * i
    garden.put("pine", side * (12.2 + 3 * math.random()), 0.2, z, 6 * math.random(), 1.5 + 0.9 * math.random())
  end
  for i = -4, 4 do
    garden.put("pine", 3.1 * i, 0.2, 28 + 2 * math.random(), i, 1.5 + math.random())
    garden.put("pine", 3.1 * i, 0.2, -45 - 2 * math.random(), i, 1.6 + math.random())
  end
end

function garden.build()
  garden.put("ground", 0, 0, 0)
  boxes()
  water()
  for _, p in ipairs(layout.plants) do garden.put(p[1], p[2], p[3], p[4], p[5], p[6]) end
  meadow()
  outside()
  gfx.setEnvironment{ panorama = "sky.png", intensity = 1.25 }
  gfx.newLight{ type = "directional", direction = { 0.52, -0.62, 0.62 }, color = { 0.55, 0.72, 1 }, intensity = 0.6 }
end

return garden
