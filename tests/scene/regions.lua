-- args: --steps 180
-- Triggers call back once a visit, layers pass through one another by rule, fields pull as they say.
local phys, scene = corsac.phys, corsac.scene
local count = { enter = 0, stay = 0, exit = 0, wrong = 0, ghost = 0 }
local faller, gone, pushed, pulled, ghost, solid

local function ball(x, y, z, more)
  local body = { shape = "sphere", radius = 0.25 }
  for k, v in pairs(more or {}) do
    body[k] = v
  end
  return scene.spawn{ position = { x, y, z }, body = body }
end

function corsac.load()
  -- Falls through a gate of 1 m: inside from when its centre... any part of it is, until it has left.
  faller = ball(0, 5, 0)
  phys.newTrigger{ shape = "box", size = { 4, 1, 4 }, position = { 0, 2, 0 },
    onEnter = function(body, trigger)
      count.enter = count.enter + 1
      if body ~= faller:getBody() or trigger == nil or body:getEntity() ~= faller then
        count.wrong = count.wrong + 1
      end
    end,
    onStay = function() count.stay = count.stay + 1 end,
    onExit = function(body) count.exit = count.exit + (body == faller:getBody() and 1 or 0) end }

  -- Destroyed inside: the exit still comes, without a body.
  gone = ball(10, 0, 0, { gravityScale = 0 })
  phys.newTrigger{ shape = "sphere", radius = 1, position = { 10, 0, 0 },
    onExit = function(body) corsac.metrics.set("gone", body == nil and 1 or 0) end }

  -- A floor that ghosts do not know, and a trigger that sees ghosts only.
  scene.spawn{ position = { 30, -0.5, 0 },
    body = { type = "static", shape = "box", size = { 6, 1, 6 }, layer = "wall" } }
  phys.setCollisionRule("ghost", "wall", false)
  ghost = ball(29, 1, 0, { layer = "ghost" })
  solid = ball(31, 1, 0, { layer = "fox" })
  phys.newTrigger{ size = { 6, 1, 6 }, position = { 30, -3, 0 }, layer = "ghost",
    onEnter = function(body) count.ghost = count.ghost + (body == ghost:getBody() and 1 or 10) end }

  -- A uniform field of 2 m/s^2 in a box, and a point field, without gravity.
  phys.newField{ type = "uniform", acceleration = { 2, 0, 0 }, position = { 0, 50, 0 },
    shape = "box", size = { 40, 4, 4 } }
  pushed = ball(-10, 50, 0, { gravityScale = 0 })
  phys.newField{ type = "point", center = { 0, 100, 0 }, strength = 8, core = 0.5, layer = "star" }
  pulled = ball(2, 100, 0, { gravityScale = 0, layer = "star", velocity = { 0, 0, 2 } }) -- a circle: v^2 r = 8
end

function corsac.fixed()
  local step = corsac.getStep()
  if step == 30 then
    gone:destroy()
  elseif step == 60 then
    local x = pushed:getPosition()
    corsac.metrics.set("pushed", x + 10) -- a t^2 / 2 after 1 s
  elseif step == 179 then
    local x, y, z = pulled:getPosition()
    corsac.metrics.set("radius", math.sqrt(x * x + (y - 100) * (y - 100) + z * z))
    local _, gy = ghost:getPosition()
    local _, sy = solid:getPosition()
    corsac.metrics.set("ghost_y", gy)
    corsac.metrics.set("solid_y", sy)
    for name, n in pairs(count) do
      corsac.metrics.set(name, n)
    end
  end
end

local expect = corsac.expect
expect("user.enter", "==", 1)
expect("user.exit", "==", 1)
expect("user.stay", ">=", 8) -- 1.5 m at about 8 m/s
expect("user.stay", "<=", 14)
expect("user.wrong", "==", 0)
expect("user.gone", "==", 1)
expect("user.ghost", "==", 1)
expect("user.ghost_y", "<", -5)
expect("user.solid_y", ">", 0.2)
expect("user.pushed", ">=", 0.97)
expect("user.pushed", "<=", 1.03)
expect("user.radius", ">=", 1.95)
expect("user.radius", "<=", 2.05)
expect("counts.triggers", "==", 3)
