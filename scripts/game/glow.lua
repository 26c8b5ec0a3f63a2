-- Everything that shines: fireflies, lanterns that wake, lanterns that swing.
local layout, garden = require("layout"), require("garden")
local scene, gfx, phys = corsac.scene, corsac.gfx, corsac.phys
local glow = { lit = 0, total = #layout.posts, gather = 0 }
local flies, posts, swings = {}, {}, {}
local WARM = { 1, 0.52, 0.18 }

local function newFly(field)
  local x = field[1] + (field[2] - field[1]) * math.random()
  local z = field[3] + (field[4] - field[3]) * math.random()
  local y = field[5] + 0.25 + 1.3 * math.random()
  flies[#flies + 1] = {
    x = x, y = y, z = z,
    phase = 6.3 * math.random(), pace = 0.35 + 0.5 * math.random(), reach = 0.5 + 0.8 * math.random(),
    light = gfx.newLight{ position = { x, y, z }, radius = 1.7, intensity = 0.1, color = { 0.75, 1, 0.25 } },
    body = garden.put("ember", x, y, z, 0, 0.018),
  }
end

local function newPost(p)
  garden.put("post", p[1], p[2], p[3], p[4])
  local x, z = p[1] + 0.42 * math.cos(p[4]), p[3] - 0.42 * math.sin(p[4])
  posts[#posts + 1] = { x = x, y = p[2] + 1.32, z = z, power = 0 }
end

-- A pendulum: the body is the lantern, its cord an unseen rod to the knot.
local function newSwing(p)
  local lantern = scene.spawn{ position = { p[1], p[2] - p[4], p[3] }, model = garden.model("lantern"),
    body = { shape = "sphere", radius = 0.12, density = 300, layer = "lantern", angularDamping = 0.02 } }
  scene.spawn{ model = garden.model("glass"), parent = lantern }
  local cord = p[4] - 0.26
  scene.spawn{ mesh = "cylinder", scale = { 0.02, cord, 0.02 }, parent = lantern,
    position = { 0, 0.26 + cord / 2, 0 }, color = { 0.05, 0.04, 0.03 } }
  local body = lantern:getBody()
  phys.newJoint{ type = "ball", b = body, anchor = { p[1], p[2], p[3] } }
  body:applyImpulse((math.random() - 0.5) * 2 * body:getMass(), 0, (math.random() - 0.5) * 2 * body:getMass())
  swings[#swings + 1] = { body = body, light = gfx.newLight{ position = { p[1], p[2] - p[4], p[3] }, radius = 5.5,
    intensity = 1.5, color = WARM } }
end

local function newFlies(count)
  local fields = { { -8, 8, 11, 24, 0 }, { -8, 8, 3, 9.5, 0.9 }, { -8, 8, -6.5, 1.5, -0.9 },
    { -10, 10, -24, -8, 0.9 }, { -8, 8, -41, -26, 0.9 } }
  for i = 1, count do newFly(fields[i % #fields + 1]) end
end

function glow.build(fireflies)
  newFlies(fireflies)
  for _, p in ipairs(layout.posts) do newPost(p) end
  phys.setCollisionRule("lantern", "fox", false)
  phys.setCollisionRule("lantern", "spirit", false)
  for _, p in ipairs(layout.swings) do newSwing(p) end
  -- A draught along the water; `sway` adds the gusts.
  phys.newField{ type = "uniform", acceleration = { 0.5, 0, 0 }, layer = "lantern",
    shape = "box", size = { 24, 8, 12 }, position = { 0, 1, -2.5 } }
  gfx.newLight{ position = { -4, 2.9, 6 }, color = { 0.35, 0.65, 1 }, intensity = 3, radius = 6 }
  glow.heart = gfx.newLight{ position = { 0, 2.9, -33 }, color = WARM, intensity = 0.3, radius = 22 }
end

local function wake(post)
  post.light = gfx.newLight{ position = { post.x, post.y, post.z }, radius = 6.5, intensity = 0, color = WARM }
  garden.put("glass", post.x, post.y, post.z)
  glow.lit = glow.lit + 1
  corsac.emit("lantern", post.x, post.y, post.z)
end

local function flicker(t, i)
  return 1 + 0.09 * math.sin(11 * t + i) + 0.06 * math.sin(17.3 * t + 2.1 * i)
end

local function burn(t, x, y, z, awake)
  for i, post in ipairs(posts) do
    local dx, dy, dz = post.x - x, post.y - y, post.z - z
    if awake and not post.light and dx * dx + dz * dz < 4 and dy * dy < 4 then wake(post) end
    if post.light then
      post.power = math.min(post.power + 0.03, 1)
      post.light:setColor(1, 0.52, 0.18, 2.6 * post.power * flicker(t, i))
    end
  end
end

-- A breath of wind keeps them swinging.
local function sway(t)
  for i, swing in ipairs(swings) do
    swing.light:setPosition(swing.body:getPosition())
    swing.light:setColor(1, 0.52, 0.18, 1.5 * flicker(t, 40 + i))
    swing.body:applyForce(0.35 * math.sin(0.7 * t + i), 0, 0.35 * math.sin(0.9 * t + 2 * i))
  end
end

-- A firefly circles its home on three sines and breathes; `gather` draws all to the great lantern.
local function fly(f, t, gather)
  local a = f.pace * t + f.phase
  local x, y, z = f.x + f.reach * math.sin(a), f.y + 0.35 * math.sin(1.7 * a + 1), f.z + f.reach * math.sin(1.3 * a + 2)
  if gather > 0 then
    local turn, ring = f.phase + 0.5 * t, 0.9 + 0.45 * f.reach + 0.5 * math.sin(3 * f.phase)
    x = x + (ring * math.cos(turn) - x) * gather
    y = y + (1.1 + 0.9 * f.phase - y) * gather
    z = z + (-33 + ring * math.sin(turn) - z) * gather
  end
  f.light:setPosition(x, y, z)
  f.light:setColor(0.75, 1, 0.25, 0.045 + 0.055 * (1 + math.sin(2.3 * a)))
  f.body:setPosition(x, y, z)
end

-- One step: wakes the lanterns near the fox, moves all that shines.
function glow.step(x, y, z, awake)
  local t = corsac.getTime()
  burn(t, x, y, z, awake)
  sway(t)
  for i = 1, #flies do fly(flies[i], t, glow.gather) end
end

function glow.count()
  return #flies + #posts + #swings
end

return glow
