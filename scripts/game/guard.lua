-- A hound of stone: walks its round over the surface made from the yard, chases what it sees.
local layout, sound = require("layout"), require("sound")
local scene, phys, gfx, nav = corsac.scene, corsac.phys, corsac.gfx, corsac.nav
local guard = { state = "patrol", chases = 0, escapes = 0 }
local SIGHT, NEAR, CATCH = 7.5, 1.6, 0.75 -- m
local surface, agent, walker, look, animator, spot, lost
local round, wait = 1, 0

local function machine(model)
  return corsac.anim.newMachine{
    initial = "move", parameters = { speed = 0 },
    states = { { name = "move", blendParameter = "speed",
      blend = { { clip = model:getClip("idle"), value = 0 }, { clip = model:getClip("walk"), value = 1 },
        { clip = model:getClip("run"), value = 3 } } } },
    transitions = {},
  }
end

-- The surface of the yard is made from the same boxes that stop the fox.
local function yard()
  local boxes = {}
  for _, box in ipairs(layout.boxes) do
    local z = box.position[3]
    if z < -7 and z > -27 then boxes[#boxes + 1] = { position = box.position, size = box.size } end
  end
  boxes[#boxes + 1] = { position = { 0, 2.1, -25.2 }, size = { 24, 2.4, 0.4 } }
  return nav.newSurface{ boxes = boxes, radius = 0.45, height = 1.2, cellSize = 0.2 }
end

local function goTo(p)
  local x, y, z = surface:nearest(p[1], p[2], p[3])
  agent:cross(surface, x, y, z)
end

function guard.spawn()
  surface = yard()
  local p, model = layout.patrol[1], corsac.anim.loadModel("models/fox.cmodel")
  walker = scene.spawn{ name = "guard", position = p }
  agent = nav.newAgent{ entity = walker, maxSpeed = 1.3, turnRate = 4, radius = 0.45 }
  look = scene.spawn{ model = model, machine = machine(model), parent = walker, scale = 2,
    color = { 0.3, 0.42, 0.62 }, rotation = { axis = { 0, 1, 0 }, angle = math.pi } }
  animator = look:getAnimator()
  spot = gfx.newLight{ type = "spot", position = p, radius = 10, intensity = 14, inner = 0.2, outer = 0.42,
    shadows = true }
  sound.loop("hum", walker, 0.5)
  goTo(layout.patrol[2])
end

function guard.position()
  return walker:getPosition()
end

-- A fox in the yard, neither spirit nor behind something, within reach of eye or ear.
local function sees(fox, x, y, z, gx, gy, gz)
  local dx, dz = x - gx, z - gz
  local d = math.sqrt(dx * dx + dz * dz)
  if fox.spirit or d > SIGHT or z > -6.6 or z < -25 then return false end
  local heading = agent:getHeading()
  local ahead = (-math.sin(heading) * dx - math.cos(heading) * dz) / math.max(d, 1e-6)
  if d > NEAR and ahead < 0.45 then return false end
  local hit = phys.rayCast(gx, gy + 0.8, gz, dx, y - gy - 0.8, dz, { layer = "world" })
  return hit == nil
end

local function turn(state, speed)
  guard.state = state
  agent:setMaxSpeed(speed)
end

local states = {}

-- Walks on and looks at nothing for a while.
function states.leave(_, _, _, _, dt)
  wait = wait - dt
  if wait < 0 then turn("patrol", 1.3) end
  if agent:getState() ~= "walking" then goTo(layout.patrol[#layout.patrol]) end
end

function states.patrol(seen, x, y, z)
  if seen then
    guard.chases = guard.chases + 1
    turn("chase", 2.5)
    sound.play("alarm", 0.9, guard.position())
    corsac.emit("seen")
    goTo{ x, y, z }
  elseif agent:getState() ~= "walking" then
    round = round % #layout.patrol + 1
    goTo(layout.patrol[round])
  end
end

function states.chase(seen, x, y, z, dt)
  if seen then
    lost = 0
    if corsac.getStep() % 12 == 0 then goTo{ x, y, z } end
  else
    lost = lost + dt
    if lost > 2.5 then
      wait = 2
      turn("search", 1.3)
      agent:stop()
    end
  end
end

function states.search(seen, x, y, z, dt)
  wait = wait - dt
  if seen then
    lost = 0
    turn("chase", 2.5)
  elseif wait < 0 then
    guard.escapes = guard.escapes + 1
    corsac.emit("escaped")
    turn("patrol", 1.3)
  end
end

-- One step; true when it has caught the fox.
function guard.step(dt, fox)
  local x, y, z = fox.position()
  local gx, gy, gz = walker:getPosition()
  lost = lost or 0
  states[guard.state](sees(fox, x, y, z, gx, gy, gz), x, y, z, dt)
  local vx, _, vz = agent:getVelocity()
  local speed = math.sqrt(vx * vx + vz * vz)
  animator:setParameter("speed", speed)
  local h = agent:getHeading()
  local sx, sz = -math.sin(h), -math.cos(h)
  spot:setPosition(gx + 0.7 * sx, gy + 1.05, gz + 0.7 * sz)
  spot:setDirection(sx, -0.25, sz)
  local angry = guard.state == "chase" or guard.state == "search"
  spot:setColor(1, angry and 0.25 or 0.8, angry and 0.12 or 0.5, 14)
  local dx, dz = x - gx - 0.5 * sx, z - gz - 0.5 * sz
  return guard.state == "chase" and not fox.spirit and dx * dx + dz * dz < CATCH * CATCH
end

function guard.rest()
  agent:stop()
  animator:setParameter("speed", 0)
end

function guard.resume()
  if guard.state ~= "patrol" then turn("patrol", 1.3) end
  goTo(layout.patrol[round])
end

-- It has had its fox: the fox comes to, and gets a start.
function guard.leave()
  wait = 5
  turn("leave", 1.8)
  goTo(layout.patrol[#layout.patrol])
end

return guard
