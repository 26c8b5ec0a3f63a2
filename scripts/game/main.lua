-- Foxlight: a fox wakes the lanterns of a walled garden. Two minutes, from title to end.
--
--   corsac run scripts/game                              play
--   corsac run scripts/game --headless --set bot=play    a bot plays it (caught, fall, again: other ends)
--   corsac run scripts/game --mod scripts/mods/midsummer
local layout, garden, glow, toys = require("layout"), require("garden"), require("glow"), require("toys")
local fox, guard, camera, hud = require("fox"), require("guard"), require("camera"), require("hud")
local sound, bot = require("sound"), require("bot")
local input, gfx = corsac.input, corsac.gfx
local plan = corsac.param("bot", "")

local game = { state = "title", since = 0, time = 0, checkpoint = 1, key = false, door = false, passed = false,
  crossed = false, caught = 0, fallen = 0 }
local held, pressed, keyEntity, rest = {}, {}, nil, nil

local function enter(state)
  game.state, game.since = state, 0
  input.setCursor(state == "play" and "locked" or "normal")
end

-- Actions that began in this step; one that is held when the scene begins must be let go first.
local function sample()
  for _, name in ipairs{ "start", "pause", "spirit", "quit" } do
    local down = input.isDown(name)
    pressed[name] = down and held[name] == false
    held[name] = down
  end
end

local function near(p, x, z, reach)
  return (p[1] - x) ^ 2 + (p[3] - z) ^ 2 < reach * reach
end

local function takeKey()
  game.key = true
  keyEntity:destroy()
  local p = layout.key
  sound.play("key", 0.8, p[1], p[2], p[3])
  hud.say("The key. Something opens in the north wall.")
  corsac.emit("key")
end

local function places(x, y, z)
  for i = game.checkpoint + 1, #layout.checkpoints do
    local p = layout.checkpoints[i]
    if near(p, x, z, 2) and math.abs(p[2] - y) < 0.8 then game.checkpoint = i end
  end
  if not fox.learnt and near(layout.stone, x, z, 1.9) then
    fox.learnt = true
    sound.play("spirit_on", 0.8)
    hud.say("The moonstone teaches you: F (X) makes you a spirit. Spirits pass the veil.")
  end
  if not game.key and near(layout.key, x, z, 1.3) then takeKey() end
  if not game.passed and fox.spirit and z < layout.veil[3] - 0.6 and z > 0 then game.passed = true end
  if not game.crossed and game.passed and z < -7.4 then game.crossed = true end
end

local hints = {
  { 23, 19, "Lanterns wake when you come near." }, { 16.5, 13.6, "The board is heavier at this end." },
  { 4.6, 2.6, "The veil lets only spirits through.", unless = "passed" },
  { -7.6, -9, "Do not let the hound see you. Behind hedges and as a spirit you are safe." },
  { -23, -24.6, "The door wants its key.", unless = "key" }, { -26.4, -30, "The great lantern." },
}

local function tell(z)
  for _, hint in ipairs(hints) do
    if z < hint[1] and z > hint[2] and not hint.said and not game[hint.unless] then
      hint.said = true
      hud.say(hint[3])
    end
  end
end

-- Back to the last resting place, behind a dark picture.
local function comeTo(how)
  game[how] = game[how] + 1
  sound.play(how == "caught" and "caught" or "splash", 0.8)
  fox.setSpirit(false)
  fox.hurt()
  guard.leave()
  hud.fade = 1
  corsac.tween{ length = 1.2, target = hud, goals = { fade = 0 }, ease = "in" }
  fox.place(layout.checkpoints[game.checkpoint])
end

local function finish()
  enter("end")
  guard.rest()
  corsac.tween{ length = 5, target = glow, goals = { gather = 1 }, ease = "smooth" }
  corsac.tween{ length = 4, from = 0.3, to = 26, step = function(v) glow.heart:setColor(1, 0.6, 0.25, v) end }
  sound.play("key", 0.7)
  corsac.emit("finished")
end

local function play(dt)
  game.time = game.time + dt
  camera.turn(dt, input.getAxis("look"), input.getAxis("move_x"))
  local s, c = math.sin(camera.yaw), math.cos(camera.yaw)
  local right, back = input.getAxis("walk_x"), input.getAxis("walk_z")
  local x, y, z = fox.position()
  if pressed.spirit and fox.learnt then fox.setSpirit(not fox.spirit and fox.breath > 0.25) end
  fox.step(dt, right * c + back * s, back * c - right * s, toys.inVeil(x, z))
  places(x, y, z)
  tell(z)
  glow.step(x, y, z, true)
  if guard.step(dt, fox) then comeTo("caught") end
  if y < -0.75 and z < 3 then comeTo("fallen") end
  if near(layout.heart, x, z, 2.6) then finish() end
  if pressed.pause then
    rest = { fox.position() }
    guard.rest()
    sound.hush(true)
    enter("pause")
  end
end

local states = { play = play }

function states.title()
  glow.step(0, -9, 0, false)
  if pressed.start then
    enter("play")
    camera.reset()
  end
end

-- The garden lives on while the game rests: only fox and hound stand still.
function states.pause()
  fox.hold(rest)
  glow.step(0, -9, 0, false)
  if pressed.quit then corsac.exit(0) end
  if pressed.pause then
    guard.resume()
    sound.hush(false)
    enter("play")
  end
end

states["end"] = function(dt)
  local x, y, z = fox.position()
  fox.step(dt, 0, 0, false)
  glow.step(x, y, z, true)
  if pressed.quit then corsac.exit(0) end
  if pressed.start and game.since > 2 then corsac.run("main.lua", { again = true }) end
end

local function openDoor(body)
  if body == fox.body and game.key and not toys.doorOpen then
    toys.openDoor()
    game.door = true
    corsac.emit("door")
  end
end

function corsac.load()
  local data = corsac.mods.data("garden", { fireflies = 220, gravity = 9.81 })
  corsac.phys.setGravity(0, -data.gravity, 0)
  garden.build()
  glow.build(data.fireflies)
  toys.build()
  fox.spawn(layout.start)
  guard.spawn()
  sound.load()
  local k = layout.key
  keyEntity = garden.put("key", k[1], k[2] + 0.3, k[3], 0, 1.3)
  gfx.newLight{ position = { k[1], k[2] + 0.7, k[3] + 0.3 }, color = { 1, 0.8, 0.35 }, intensity = 1.6, radius = 4 }
  for _, layer in ipairs{ "fox", "spirit" } do
    corsac.phys.newTrigger{ size = { 4, 3, 3.4 }, position = { 0, 2, -23.4 }, layer = layer, onEnter = openDoor }
  end
  enter("title")
  if plan ~= "" then bot.start(plan, game, fox, guard, glow, toys) end
end

-- What a run came to, for its metrics.
local function report()
  local set = corsac.metrics.set
  local x, y, z = fox.position()
  set("x", x)
  set("y", y)
  set("z", z)
  set("again", corsac.getRunData() and 1 or 0)
  set("playing", game.state == "play" and 1 or 0)
  set("finished", game.state == "end" and 1 or 0)
  for _, name in ipairs{ "key", "door", "passed", "crossed" } do set(name, game[name] and 1 or 0) end
  for _, name in ipairs{ "caught", "fallen", "time" } do set(name, game[name]) end
  set("escaped", guard.escapes)
  set("lanterns", glow.lit)
end

function corsac.fixed(dt)
  sample()
  game.since = game.since + dt
  states[game.state](dt)
  if keyEntity and not game.key then
    local t = corsac.getTime()
    keyEntity:setPosition(layout.key[1], layout.key[2] + 0.35 + 0.07 * math.sin(2 * t), layout.key[3])
    keyEntity:setRotation(0, math.sin(0.6 * t), 0, math.cos(0.6 * t))
  end
  report()
end

function corsac.update(dt)
  local x, y, z = fox.position()
  if game.state == "title" then
    camera.title(game.since)
  elseif game.state == "end" and game.since > 1 then
    camera.ending(game.since)
  else
    camera.follow(dt, x, y, z, 0.38)
  end
end

function corsac.draw()
  hud.draw(game, fox, glow)
end
