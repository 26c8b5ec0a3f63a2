-- Sounds by name, music, footsteps.
local audio = corsac.audio
local sound = {}
local loaded, music, night = {}, nil, nil

local function get(name)
  loaded[name] = loaded[name] or audio.newSound("sounds/" .. name .. (name == "music" and ".ogg" or ".wav"))
  return loaded[name]
end

function sound.load()
  for name in ("step_grass1 step_grass2 step_stone1 step_stone2 step_wood1 step_wood2 light key spirit_on " ..
    "spirit_off door alarm caught splash jump"):gmatch("%S+") do get(name) end
  night = audio.newSource{ sound = get("night"), flat = true, loop = true, gain = 0.5, group = "nature" }
  music = audio.newSource{ sound = get("music"), flat = true, loop = true, gain = 0, group = "music" }
  music:fade(0.35, 4)
  for _, z in ipairs{ -0.4, -4.5 } do
    audio.newSource{ sound = get("water"), position = { 0, -1, z }, loop = true, gain = 0.5, reference = 2,
      group = "nature" }
  end
end

-- A sound at a place, or everywhere without one.
function sound.play(name, gain, x, y, z, pitch)
  audio.newSource{ sound = get(name), position = x and { x, y, z }, flat = not x, gain = gain, reference = 3,
    pitch = pitch or 1 }
end

function sound.loop(name, entity, gain)
  return audio.newSource{ sound = get(name), entity = entity, loop = true, gain = gain, reference = 1.5 }
end

function sound.hush(quiet)
  music:fade(quiet and 0.1 or 0.35, 0.6)
  night:fade(quiet and 0.2 or 0.5, 0.6)
end

function sound.step(ground, gain, x, y, z)
  sound.play("step_" .. ground .. math.random(2), gain, x, y, z, 0.92 + 0.16 * math.random())
end

return sound
