-- Follows the fox at the end of a boom that walls shorten.
local phys, gfx = corsac.phys, corsac.gfx
local camera = { yaw = 0 }
local REACH, RADIUS = 4.3, 0.25 -- m
local x, y, z, boom

-- Turned by the step: the way the fox walks depends on it.
function camera.turn(dt, look, move)
  camera.yaw = camera.yaw - 2.2 * look * dt - 0.0025 * move
end

local function ease(from, to, dt, time)
  return from and from + (to - from) * (1 - math.exp(-dt / time)) or to
end

local function place(px, py, pz, tx, ty, tz)
  gfx.setCamera{ position = { px, py, pz }, target = { tx, ty, tz }, fov = 1.0, near = 0.08, far = 60 }
end

function camera.follow(dt, fx, fy, fz, pitch)
  x, y, z = ease(x, fx, dt, 0.09), ease(y, fy + 0.45, dt, 0.16), ease(z, fz, dt, 0.09)
  local s, c = math.sin(camera.yaw), math.cos(camera.yaw)
  local flat, up = REACH * math.cos(pitch), REACH * math.sin(pitch)
  local hit, _, _, _, _, _, _, part = phys.sphereCast(x, y, z, RADIUS, flat * s, up, flat * c, { layer = "world" })
  local free = hit and part or 1
  boom = boom and free > boom and ease(boom, free, dt, 0.5) or free
  place(x + boom * flat * s, y + boom * up, z + boom * flat * c, x, y, z)
end

-- From the gate over the court, the moon on the left.
function camera.title(t)
  place(1.2 + 0.5 * math.sin(0.13 * t), 1.3, 22.9, -0.7, 2.2, 12)
end

function camera.ending(t)
  local a = 0.5 + 0.12 * t
  place(6.6 * math.sin(a), 3.2 + 0.05 * math.min(t, 60), -33 + 6.6 * math.cos(a), 0, 3, -33)
end

function camera.reset()
  x, y, z, boom = nil, nil, nil, nil
end

return camera
