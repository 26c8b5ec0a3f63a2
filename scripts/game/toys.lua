-- What gives way: see-saw, rope bridge and door, which are joints; the veil; chestnuts that fall.
local layout, garden, sound = require("layout"), require("garden"), require("sound")
local scene, phys, gfx = corsac.scene, corsac.phys, corsac.gfx
local toys = { doorOpen = false }
local hinges, nuts = {}, {}

-- What falls or tips is heard by how hard it strikes.
local function knock(name, gain, least)
  return function(self, _, speed)
    if speed > least then
      local x, y, z = self:getPosition()
      sound.play(name, math.min(gain * speed, 0.6), x, y, z, 0.9 + 0.2 * math.random())
    end
  end
end

-- Every few seconds a chestnut drops from one of the trees; the oldest is picked up for it.
local function drop()
  local tree = layout.plants[math.random(10)]
  local x, z = tree[2] + 1.6 * math.random() - 0.8, tree[4] + 1.6 * math.random() - 0.8
  if #nuts < 10 then
    nuts[#nuts + 1] = scene.spawn{ position = { x, tree[3] + 3, z }, mesh = "sphere", color = { 0.16, 0.07, 0.03 },
      body = { shape = "sphere", radius = 0.06, density = 600, restitution = 0.3, layer = "nut", angularDamping = 1.5,
        onContact = knock("step_wood1", 0.08, 0.6) } }
  else
    local nut = table.remove(nuts, 1)
    nut:setPosition(x, tree[3] + 3, z)
    nut:getBody():setVelocity(0, -1, 0)
    nuts[#nuts + 1] = nut
  end
end

-- The board's heavy end lies in the court; a fox on the light end brings it down on the terrace.
local function seesaw()
  local x, z, height = 2, 12.4, 0.78
  garden.put("trestle", x, 0, z)
  local board = scene.spawn{ name = "seesaw", position = { x, height, z }, tags = { "wood" },
    model = garden.model("board"), rotation = { axis = { 1, 0, 0 }, angle = 0.27 },
    body = { layer = "seesaw", angularDamping = 0.6, friction = 0.8, onContact = knock("step_wood2", 0.5, 0.4),
      shapes = { { shape = "box", size = { 1, 0.08, 5.2 }, density = 40 },
        { shape = "box", size = { 0.9, 0.1, 0.3 }, density = 90, position = { 0, -0.02, 2.4 } } } } }
  phys.newJoint{ type = "revolute", b = board:getBody(), anchor = { x, height, z }, axis = { 1, 0, 0 },
    lower = -0.5, upper = 0.5 }
end

-- Where the k-th of `count` knots of the bridge hangs: a parabola under the two banks.
local function knot(k, count)
  local part = k / count
  return 0.87 - 4 * 0.42 * part * (1 - part), 2.0 - 9.0 * part
end

local function bridge()
  local count, last = 20, nil
  for _, other in ipairs{ "bridge", "world", "lantern" } do phys.setCollisionRule("bridge", other, false) end
  local function tie(a, b, y, z)
    for _, x in ipairs{ -0.6, 0.6 } do phys.newJoint{ type = "ball", a = a, b = b, anchor = { x, y, z } } end
  end
  for i = 1, count do
    local y0, z0 = knot(i - 1, count)
    local y1, z1 = knot(i, count)
    local plank = scene.spawn{ position = { 0, (y0 + y1) / 2, (z0 + z1) / 2 }, model = garden.model("plank"),
      tags = { "wood" }, rotation = { axis = { 1, 0, 0 }, angle = math.atan2(y1 - y0, z0 - z1) },
      body = { shape = "box", size = { 1.3, 0.06, 0.44 }, density = 260, layer = "bridge", friction = 0.8,
        linearDamping = 0.4, angularDamping = 0.8 } }
    tie(last, plank:getBody(), y0, z0)
    last = plank:getBody()
  end
  tie(nil, last, knot(count, count))
  for _, x in ipairs{ -0.72, 0.72 } do
    for _, z in ipairs{ 2.15, -7.1 } do garden.put("stake", x, 0.9, z) end
    garden.put("stake", x * 2.2, -1.6, -1, 0, 1.5)
    garden.put("stake", x * 2.2, -1.6, -3.6, 0, 1.5)
  end
end

local function door()
  local p = layout.door
  phys.setCollisionRule("door", "world", false)
  phys.setCollisionRule("door", "door", false)
  for side = -1, 1, 2 do
    local leaf = scene.spawn{ position = { p[1] + side * 0.55, p[2] + 1.12, p[3] }, tags = { "wood" },
      body = { shape = "box", size = { 1.08, 2.2, 0.12 }, density = 300, layer = "door", angularDamping = 1 } }
    local shown = scene.spawn{ model = garden.model("leaf_of_door"), parent = leaf, position = { 0, -1.1, 0 } }
    if side > 0 then shown:setRotation(0, 1, 0, 0) end
    hinges[#hinges + 1] = phys.newJoint{ type = "revolute", b = leaf:getBody(), axis = { 0, side, 0 },
      anchor = { p[1] + side * 1.09, p[2] + 1.12, p[3] }, lower = -0.001, upper = 0.001 }
  end
end

local function newVeil()
  local p = layout.veil
  local material = gfx.newMaterial{ baseColor = { 0.3, 0.6, 1, 0.35 }, roughness = 0.2, emissive = { 0.05, 0.16, 0.4 },
    alpha = "blend", doubleSided = true }
  scene.spawn{ position = { p[1], p[2] + 1.25, p[3] }, mesh = "box", material = material,
    body = { type = "static", shape = "box", size = { 2.6, 2.5, 0.12 }, layer = "veil" } }
  for i = -1, 1 do
    gfx.newLight{ position = { i * 0.8, p[2] + 0.5 + 0.6 * (i + 1), p[3] + 0.4 }, radius = 3, intensity = 0.5,
      color = { 0.3, 0.6, 1 } }
  end
end

function toys.build()
  phys.setCollisionRule("nut", "spirit", false)
  corsac.every(1.7, drop)
  seesaw()
  bridge()
  door()
  newVeil()
end

function toys.openDoor()
  toys.doorOpen = true
  for _, hinge in ipairs(hinges) do
    hinge:setLimits(0, 1.75)
    hinge:setMotor(0.9, 120)
  end
  sound.play("door", 0.9, layout.door[1], 2, layout.door[3])
end

-- How far the door stands open, rad.
function toys.doorAngle()
  return hinges[1]:getValue()
end

-- Whether a ball at x, z is held by the veil.
function toys.inVeil(x, z)
  return math.abs(z - layout.veil[3]) < 0.4 and math.abs(x) < 1.6
end

return toys
