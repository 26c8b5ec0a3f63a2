-- What is written over the picture.
local gfx = corsac.gfx
local hud = { fade = 0 }
local hint, since = "", -100
local GOLD, PALE = { 1, 0.82, 0.5 }, { 0.8, 0.87, 1 }
local width, height = 1280, 720

function hud.say(text)
  if text ~= hint then hint, since = text, corsac.getTime() end
end

-- Height of a line in pixels, within what fonts are drawn at.
local function pixels(size)
  return math.max(4, math.min(size * height, 256))
end

-- Text about the middle of the frame; y and size in shares of its height.
local function center(text, y, size, color)
  gfx.text(text, { x = width / 2, y = y * height, size = pixels(size), align = 0.5, font = "sans", color = color })
end

local function left(text, y, size, color)
  gfx.text(text, { x = 0.04 * height, y = y * height, size = pixels(size), font = "sans", color = color })
end

local function dim(alpha)
  gfx.rect(0, 0, width, height, { 0.01, 0.015, 0.03, alpha })
end

function hud.title(t)
  dim(0.2)
  center("FOXLIGHT", 0.17, 0.17, GOLD)
  center("wake the lanterns of the walled garden", 0.36, 0.042, PALE)
  center("Enter, click or (A) to begin", 0.82, 0.036, { 1, 1, 1, 0.7 + 0.3 * math.sin(3 * t) })
  center("WASD or stick: walk   ·   Space (A): jump   ·   Shift (LB): slow   ·   Mouse: look   ·   " ..
    "F (X): spirit   ·   P: pause", 0.9, 0.027, PALE)
end

local function spiritBar(fox)
  local h = height / 100
  left("spirit", 0.9, 0.028, { 0.6, 0.8, 1 })
  gfx.roundRect(4 * h, 94 * h, 28 * h, 2 * h, h, { 0.05, 0.08, 0.14, 0.7 })
  gfx.roundRect(4 * h, 94 * h, math.max(28 * fox.breath, 2) * h, 2 * h, h,
    fox.spirit and { 0.6, 0.85, 1 } or { 0.3, 0.5, 0.9 })
end

function hud.play(game, fox, glow)
  left(("lanterns %d / %d"):format(glow.lit, glow.total), 0.035, 0.038, GOLD)
  if game.key then left("key", 0.08, 0.034, GOLD) end
  if fox.learnt then spiritBar(fox) end
  local shown = corsac.getTime() - since
  local alpha = math.min(1, shown * 2, 7 - shown)
  if alpha > 0 then center(hint, 0.84, 0.038, { 1, 1, 1, alpha }) end
  if hud.fade > 0 then dim(hud.fade) end
end

function hud.pause()
  dim(0.6)
  center("paused", 0.34, 0.1, GOLD)
  center("P or Escape: go on   ·   Backspace: leave the garden", 0.52, 0.036, PALE)
end

function hud.finish(game, glow, t)
  local minutes, seconds = math.floor(game.time / 60), math.floor(game.time % 60)
  center("the garden is awake", 0.1, 0.1, { 1, 0.86, 0.55, math.min(1, t / 2) })
  center(("%d of %d lanterns in %d:%02d"):format(glow.lit, glow.total, minutes, seconds), 0.23, 0.045, PALE)
  if t > 3 then center("Enter: once more   ·   Backspace: good night", 0.9, 0.036, PALE) end
end

local draws = {
  title = function(game) hud.title(game.since) end,
  play = hud.play,
  pause = hud.pause,
  ["end"] = function(game, _, glow) hud.finish(game, glow, game.since) end,
}

function hud.draw(game, fox, glow)
  width, height = gfx.getSize()
  draws[game.state](game, fox, glow)
end

return hud
