-- The fox: a ball that is pushed about, and a model that follows it.
local sound = require("sound")
local scene, phys, gfx, input = corsac.scene, corsac.phys, corsac.gfx, corsac.input
local fox = { spirit = false, breath = 1, learnt = false, grounded = false, speed = 0 }
local RADIUS, RUN, SLOW, JUMP = 0.22, 3.1, 1.2, 3.4
local SPIRIT_TIME, REST_TIME = 6, 5 -- s of a full breath, and to draw one
local entity, body, look, animator, light, since
local heading, air = math.pi, 0

local function machine(model)
  local idle, walk, run = model:getClip("idle"), model:getClip("walk"), model:getClip("run")
  return corsac.anim.newMachine{
    initial = "move", parameters = { speed = 0, air = 0 },
    states = {
      { name = "move", blendParameter = "speed",
        blend = { { clip = idle, value = 0 }, { clip = walk, value = 0.8 }, { clip = run, value = 2.4 } } },
      { name = "jump", clip = model:getClip("jump"), loop = "once" },
      { name = "hit", clip = model:getClip("hit"), loop = "once" },
    },
    transitions = {
      { to = "hit", event = "hit", length = 0.08 },
      { from = "hit", to = "move", length = 0.2 },
      { from = "move", to = "jump", event = "jump", length = 0.08 },
      { from = "jump", to = "move", length = 0.2 },
    },
  }
end

function fox.spawn(place)
  local model = corsac.anim.loadModel("models/fox.cmodel")
  entity = scene.spawn{ name = "fox", position = { place[1], place[2] + RADIUS, place[3] },
    body = { shape = "sphere", radius = RADIUS, density = 180, friction = 0, layer = "fox" },
    rotation = { axis = { 0, 1, 0 }, angle = math.pi } }
  body = entity:getBody()
  look = scene.spawn{ model = model, machine = machine(model), parent = entity, scale = 1.25,
    position = { 0, -RADIUS, 0 } }
  animator = look:getAnimator()
  light = gfx.newLight{ position = place, radius = 4.5, intensity = 0.5, color = { 1, 0.75, 0.5 } }
  phys.setCollisionRule("spirit", "veil", false)
  fox.entity, fox.body, since = entity, body, 0
end

function fox.position()
  return body:getPosition()
end

function fox.place(p)
  body:setPosition(p[1], p[2] + RADIUS + 0.05, p[3])
  body:setVelocity(0, 0, 0)
end

function fox.hurt()
  animator:send("hit")
end

local kinds = { wood = "wood", wall = "stone", stone = "stone" }

-- What is under the paws: its normal and the sound of it.
local function ground(x, y, z)
  local under, _, _, _, nx, ny, nz = phys.sphereCast(x, y, z, RADIUS * 0.9, 0, -0.16, 0, { skip = body })
  if not under then return nil end
  local kind, on = "grass", under:getEntity()
  for tag, name in pairs(kinds) do
    if on and on:hasTag(tag) then kind = name end
  end
  return kind, nx, ny, nz
end

function fox.setSpirit(on)
  if on == fox.spirit then return end
  fox.spirit = on
  body:setLayer(on and "spirit" or "fox")
  if on then look:setColor(0.12, 0.9, 5) else look:setColor(1, 1, 1) end
  light:setColor(on and 0.35 or 1, on and 0.65 or 0.75, on and 1 or 0.5, on and 2.2 or 0.5)
  local x, y, z = body:getPosition()
  sound.play(on and "spirit_on" or "spirit_off", 0.6, x, y, z)
  corsac.emit("spirit", on)
end

-- Spirit lasts for a breath, longer only while the veil still holds the fox.
local function breathe(dt, inside)
  if fox.spirit then
    fox.breath = math.max(fox.breath - dt / SPIRIT_TIME, 0)
    if fox.breath == 0 and not inside then fox.setSpirit(false) end
  else
    fox.breath = math.min(fox.breath + dt / REST_TIME, 1)
  end
end

local function turnTo(wanted, dt)
  local turn = (wanted - heading + math.pi) % (2 * math.pi) - math.pi
  local rate = math.max(-9, math.min(9, 9 * turn))
  heading = heading + rate * dt
  body:setAngularVelocity(0, rate, 0)
end

local function steps(kind, dt, x, y, z)
  since = since + fox.speed * dt
  if kind and since > (fox.speed > 2 and 0.75 or 0.4) then
    since = 0
    sound.step(kind, math.min(0.1 + 0.1 * fox.speed, 0.35), x, y - RADIUS, z)
  end
end

-- One step of a playing fox. wx, wz: where to, in the world, length 0 to 1.
function fox.step(dt, wx, wz, inside)
  local x, y, z = body:getPosition()
  local kind, nx, ny, nz = ground(x, y, z)
  local vx, vy, vz = body:getVelocity()
  local length = math.sqrt(wx * wx + wz * wz)
  local speed = (input.isDown("slow") and SLOW or RUN) / math.max(length, 1)
  local k = kind and 0.22 or 0.06
  vx, vz = vx + (wx * speed - vx) * k, vz + (wz * speed - vz) * k
  fox.grounded = kind ~= nil
  air = kind and 0 or air + dt
  if kind and input.isDown("jump") and not fox.jumped then
    vy = JUMP
    animator:send("jump")
    sound.play("jump", 0.4, x, y, z)
  elseif kind and length < 0.1 and ny > 0.7 then
    -- At rest on a slope: give back the part of gravity that would pull the ball down along it.
    local _, g = phys.getGravity()
    vx, vy, vz = vx + g * dt * ny * nx, vy - g * dt * (1 - ny * ny), vz + g * dt * ny * nz
  end
  fox.jumped = input.isDown("jump")
  body:setVelocity(vx, vy, vz)
  if length > 0.1 then turnTo(math.atan2(wx, wz), dt) else body:setAngularVelocity(0, 0, 0) end
  fox.speed = math.sqrt(vx * vx + vz * vz)
  animator:setParameter("speed", fox.speed)
  animator:setSpeed(fox.speed > 2 and fox.speed / 2.5 or 1)
  steps(kind, dt, x, y, z)
  breathe(dt, inside)
  light:setPosition(x, y + 0.75, z)
end

-- While the game rests: holds the fox where it is.
function fox.hold(p)
  body:setPosition(p[1], p[2], p[3])
  body:setVelocity(0, 0, 0)
  body:setAngularVelocity(0, 0, 0)
  animator:setParameter("speed", 0)
  light:setPosition(p[1], p[2] + 0.75, p[3])
end

return fox
