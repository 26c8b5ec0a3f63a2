-- Plays the garden from title to end through the input stream, and insists on what must happen.
local input, camera, layout = corsac.input, require("camera"), require("layout")
local bot = {}
local game, fox, guard, glow, toys

local function insist(holds, what)
  if not holds then error("bot: " .. what, 2) end
end

local function tap(key)
  input.press(key)
  corsac.wait(0.1)
  input.release(key)
  corsac.wait(0.1)
end

local function stick(x, z)
  local s, c = math.sin(camera.yaw), math.cos(camera.yaw)
  input.setAxis("pad_leftx", x * c - z * s)
  input.setAxis("pad_lefty", x * s + z * c)
end

-- Walks until the fox is within `reach` of a place; the engine's clock limits it.
local function walk(x, z, reach, limit)
  local give_up = corsac.getTime() + (limit or 12)
  while true do
    local fx, _, fz = fox.position()
    local dx, dz = x - fx, z - fz
    local d = math.sqrt(dx * dx + dz * dz)
    if d < (reach or 0.4) then break end
    insist(corsac.getTime() < give_up, ("%.1f, %.1f is out of reach from %.2f, %.2f"):format(x, z, fx, fz))
    stick(dx / d, dz / d)
    corsac.wait()
  end
  stick(0, 0)
end

local function along(places)
  for _, p in ipairs(places) do walk(p[1], p[2], p[3]) end
end

local function wait(what, limit, done)
  local give_up = corsac.getTime() + limit
  while not done() do
    insist(corsac.getTime() < give_up, what .. ": not within " .. limit .. " s")
    corsac.wait()
  end
end

local function begin()
  corsac.wait(1)
  tap("enter")
  insist(game.state == "play", "Enter does not begin the game")
  walk(-1.2, 20.6)
  insist(glow.lit == 1, "the first lantern did not wake")
  tap("p")
  insist(game.state == "pause", "P does not pause")
  local x, _, z = fox.position()
  stick(1, 0)
  corsac.wait(0.7)
  stick(0, 0)
  local px, _, pz = fox.position()
  insist(math.abs(px - x) + math.abs(pz - z) < 0.01, "the fox walks while the game is paused")
  tap("escape")
  insist(game.state == "play", "Escape does not go on")
end

local function court()
  along{ { 1.3, 18 }, { -1.7, 15.6 }, { 2, 16.2 }, { 2, 15.2, 0.2 }, { 2, 9 } }
  local _, y = fox.position()
  insist(y > 1, "the see-saw does not lead to the terrace")
end

local function veil()
  walk(-2.9, 6.9, 0.3)
  insist(fox.learnt, "the moonstone teaches nothing")
  along{ { -1.2, 4.2 }, { 0, 3.6 } }
  stick(0, -1)
  corsac.wait(1)
  local _, _, z = fox.position()
  insist(z > layout.veil[3], "the veil does not hold a fox of flesh")
  tap("f")
  insist(fox.spirit, "F makes no spirit")
  walk(0, 1.4)
  insist(game.passed, "the veil does not let a spirit pass")
  tap("f")
  insist(not fox.spirit, "F does not end it")
end

local function bridge()
  along{ { 0, -2.4 }, { 0, -8.4 } }
  insist(game.crossed and game.fallen == 0, "the bridge does not bear the fox")
end

-- Shows itself, runs, and hides as a spirit until the hound gives up.
local function escape()
  walk(0, -9.6)
  wait("the hound sees the fox", 40, function() return guard.state == "chase" end)
  corsac.wait(0.5)
  tap("f")
  along{ { -3.4, -10.6 }, { -3.4, -14.6 } }
  wait("the hound gives up", 12, function() return guard.state == "patrol" end)
  insist(guard.escapes > 0 and game.caught == 0, "the hound was not escaped from")
end

local function key()
  along{ { -3.4, -17.6 }, { -9.8, -18.4 }, { -9.8, -21 }, { -8.4, -21.7 } }
  insist(game.key, "the key is not taken")
  insist(not toys.doorOpen, "the door opened by itself")
end

local function door()
  along{ { -4, -22.4 }, { 0, -23.2 } }
  insist(toys.doorOpen, "the door's trigger does not open it")
  wait("the door swings", 8, function() return toys.doorAngle() > 1.3 end)
  along{ { 0, -26.6 }, { -1.4, -28.4 }, { 2.2, -29.4 } }
  walk(0, -30.7)
  wait("the end", 3, function() return game.state == "end" end)
end

-- Lets itself be seen, and stays.
local function caught()
  walk(0, -9.6)
  wait("the hound catches the fox", 60, function() return game.caught == 1 end)
  corsac.wait(0.2)
  local x, _, z = fox.position()
  insist(math.abs(x) < 0.5 and math.abs(z + 8.6) < 0.5, "the fox does not come to where it crossed the bridge")
end

local function fall()
  stick(0.9, -0.4)
  wait("the fox falls into the water", 8, function() return game.fallen == 1 end)
  stick(0, 0)
  corsac.wait(0.2)
  local _, y, z = fox.position()
  insist(y > 0.9 and z > 2, "the fox does not come to the near bank")
end

-- Asks for the garden once more, and in the second one leaves from its title.
local function again()
  corsac.wait(2.5)
  tap("enter")
  insist(false, "Enter does not begin anew")
end

local plans = {
  play = { begin, court, veil, bridge, escape, key, door },
  caught = { begin, court, veil, bridge, caught },
  fall = { begin, court, veil, fall },
  again = corsac.getRunData() and {} or { begin, court, veil, bridge, escape, key, door, again },
}

function bot.start(plan, ...)
  game, fox, guard, glow, toys = ...
  local parts = plans[plan] or error("bot: the plans are play, caught, fall and again, not " .. plan, 0)
  corsac.spawn(function()
    for _, part in ipairs(parts) do part() end
    corsac.wait(4)
    corsac.exit(0)
  end)
  corsac.expect("accuracy.nan", "==", 0)
  if plan ~= "play" then return end
  for name, least in pairs{ finished = 1, key = 1, door = 1, passed = 1, crossed = 1, escaped = 1, lanterns = 10 } do
    corsac.expect("user." .. name, ">=", least)
  end
end

return bot
