-- One thin line through every room: a night room with 200 lights, drawn now forward, now clustered; a
-- fox that walks a path, changes its gait by a state machine and comes through a gate that lets a ball
-- fall; a lantern that hums from left to right.
--
--   corsac run scripts/scenes/card.lua
--   corsac run scripts/scenes/card.lua --headless --steps 900 --shot out/card.png --audio out/card.wav
--
-- render: toggle, forward or clustered. guest: a .cmodel that `corsac convert` made, beside this file.
local phys, gfx, scene, nav = corsac.phys, corsac.gfx, corsac.scene, corsac.nav
local lights = corsac.param("lights", 200)
local render = corsac.param("render", "toggle")
local guest = corsac.param("guest", "")

local walker, shadow, ball, lantern, glow, agent, goal
local entered, left, opened = 0, 0, 0

local function block(x, y, z, sx, sy, sz, more)
  local options = { position = { x, y, z }, mesh = "box", color = { 0.55, 0.5, 0.45 },
    body = { type = "static", shape = "box", size = { sx, sy, sz } } }
  for k, v in pairs(more or {}) do
    if k == "layer" then options.body.layer = v else options[k] = v end
  end
  return scene.spawn(options)
end

local function room()
  gfx.setBackground(0.004, 0.006, 0.015)
  gfx.setAmbient(0.012, 0.014, 0.025)
  gfx.setCamera{ position = { 0, 4.2, 10.5 }, target = { 0, 1.1, 0 }, fov = 0.95, far = 60 }
  block(0, -0.5, 0, 18, 1, 12)
  block(0, 2.5, -6.25, 18, 5, 0.5)
  block(-9.25, 2.5, 0, 0.5, 5, 12)
  block(9.25, 2.5, 0, 0.5, 5, 12)
  for i = 1, lights - 2 do
    -- A lattice with some play, hues around the circle: dim enough that no light rules the room.
    local column, row = (i - 1) % 20, math.floor((i - 1) / 20)
    local hue = 2 * math.pi * (i * 0.618034)
    gfx.newLight{ type = "point", radius = 2.6, intensity = 0.5,
      position = { -8.6 + 0.9 * column + 0.3 * math.random(), 0.35 + 1.4 * math.random(), -5.6 + 1.15 * row },
      color = { 0.6 + 0.4 * math.cos(hue), 0.6 + 0.4 * math.cos(hue - 2.1), 0.6 + 0.4 * math.cos(hue + 2.1) } }
  end
end

-- Two of the lights have a place of their own: one over the gate, one that the lantern carries.
local function lamps()
  gfx.newLight{ type = "point", position = { 0, 5.2, 0 }, radius = 6, intensity = 8, color = { 1, 0.85, 0.6 } }
  glow = gfx.newLight{ type = "point", position = { -7, 2.2, 1.6 }, radius = 3.5, intensity = 2.5,
    color = { 1, 0.8, 0.45 } }
end

local function machine(model)
  return corsac.anim.newMachine{
    initial = "idle",
    states = {
      { name = "idle", clip = model:getClip("idle"),
        onEnter = function() entered = entered + 1 end, onExit = function() left = left + 1 end },
      { name = "walk", clip = model:getClip("walk"),
        onEnter = function() entered = entered + 1 end, onExit = function() left = left + 1 end },
    },
    transitions = {
      { from = "idle", to = "walk", length = 0.25, fade = "smooth",
        condition = function() return agent:getState() == "walking" end },
      { from = "walk", to = "idle", length = 0.25, fade = "smooth",
        condition = function() return agent:getState() ~= "walking" end },
    },
  }
end

local function path()
  -- A loop around the middle; the way back along the wall is longer, so the fox takes the front.
  local graph = nav.newGraph{ name = "garden" }
  local points = { { -7, 3 }, { -3.5, 3.4 }, { 0, 3 }, { 3, 3.2 }, { 5.5, 3.4 }, { 7, -4 }, { 0, -4.5 }, { -7, -4 } }
  for i, p in ipairs(points) do
    local id = graph:add(p[1], 0, p[2])
    if i > 1 then graph:connect(id - 1, id) end
  end
  graph:connect(0, #points - 1)
  graph:connect(1, 6)
  graph:disconnect(1, 6) -- the pond is in the way
  assert(graph:nearest(6, 0, 2) == 4)
  return graph
end

function corsac.load()
  room()
  lamps()
  local model = corsac.anim.loadModel("models/fox.cmodel")
  walker = scene.spawn{ name = "walker", position = { -7, 0, 3 } }
  agent = nav.newAgent{ entity = walker, maxSpeed = 1.2, turnRate = 4 }
  scene.spawn{ name = "fox", parent = walker, model = model, machine = machine(model), scale = 2,
    rotation = { axis = { 0, 1, 0 }, angle = math.pi } } -- the model faces +Z, agents -Z
  shadow = scene.spawn{ name = "shadow", position = { -7, 0.25, 3 }, -- what triggers see of the fox
    body = { type = "kinematic", shape = "sphere", radius = 0.25, layer = "fox" } }
  goal = path()

  block(0, 2.4, -2, 2.2, 0.15, 2.2, { layer = "gate", color = { 0.9, 0.75, 0.2 } })
  ball = scene.spawn{ name = "ball", position = { 0, 3.1, -2 }, mesh = "sphere", color = { 0.9, 0.3, 0.25 },
    body = { shape = "sphere", radius = 0.6, layer = "ball" } }
  phys.newTrigger{ shape = "box", size = { 1, 2, 2 }, position = { 0, 1, 3 }, layer = "fox",
    onEnter = function()
      opened = opened + 1
      phys.setCollisionRule("ball", "gate", false)
    end }
  phys.newField{ type = "point", center = { 0, 0.6, -2 }, strength = 4, core = 1, layer = "ball" }

  lantern = scene.spawn{ name = "lantern", position = { -7, 2.2, 1 }, mesh = "sphere", scale = 0.25,
    color = { 1, 0.9, 0.6 } }
  corsac.audio.newSource{ sound = corsac.audio.newSound("sounds/hum.wav"), entity = lantern, loop = true,
    reference = 3 }
  if guest ~= "" then
    local someone = corsac.anim.loadModel(guest)
    scene.spawn{ name = "guest", model = someone, clip = someone:getClips()[1], position = { 2.6, 0, -0.5 } }
  end
  gfx.setRender(render == "toggle" and "forward" or render)
end

function corsac.fixed()
  local step = corsac.getStep()
  local along = -7 + 14 * math.min(step / 900, 1)
  lantern:setPosition(along, 2.2, 1)
  glow:setPosition(along, 2.2, 1.6)
  if step == 30 then
    agent:go(goal, 5.5, 0, 3.4)
  end
  -- Forward and clustered in turn, two seconds each, and clustered at the end.
  if render == "toggle" and step % 120 == 0 then
    gfx.setRender(math.floor(step / 120) % 2 == 1 and "clustered" or "forward")
  end
  local _, height = ball:getPosition()
  local x, _, z = walker:getPosition()
  shadow:setPosition(x, 0.25, z)
  corsac.metrics.set("ball_y", height)
  corsac.metrics.set("fox_x", x)
  corsac.metrics.set("entered", entered)
  corsac.metrics.set("left", left)
  corsac.metrics.set("opened", opened)
end
