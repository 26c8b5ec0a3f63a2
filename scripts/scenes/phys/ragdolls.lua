-- Twenty ragdolls fall into a heap and come to rest: no part flies off, joints hold, knees bend one
-- way only.
local phys, scene, gfx = corsac.phys, corsac.scene, corsac.gfx
local n = corsac.param("n", 20)
local dolls, steps = {}, 0
local parts = { -- parent, head, tail, radius, mass, hinge
  { 0, { 0, 0.95, 0 }, { 0, 1.15, 0 }, 0.13, 15 },
  { 1, { 0, 1.15, 0 }, { 0, 1.45, 0 }, 0.14, 20 },
  { 2, { 0, 1.45, 0 }, { 0, 1.72, 0 }, 0.1, 5 },
  { 2, { 0.2, 1.4, 0 }, { 0.48, 1.4, 0 }, 0.05, 2.5 },
  { 4, { 0.48, 1.4, 0 }, { 0.76, 1.4, 0 }, 0.04, 2, { 0, 1, 0 }, -2.2, 0 },
  { 2, { -0.2, 1.4, 0 }, { -0.48, 1.4, 0 }, 0.05, 2.5 },
  { 6, { -0.48, 1.4, 0 }, { -0.76, 1.4, 0 }, 0.04, 2, { 0, 1, 0 }, 0, 2.2 },
  { 1, { 0.1, 0.9, 0 }, { 0.1, 0.5, 0 }, 0.07, 8 },
  { 8, { 0.1, 0.5, 0 }, { 0.1, 0.05, 0 }, 0.05, 5, { 1, 0, 0 }, 0, 2.2 },
  { 1, { -0.1, 0.9, 0 }, { -0.1, 0.5, 0 }, 0.07, 8 },
  { 10, { -0.1, 0.5, 0 }, { -0.1, 0.05, 0 }, 0.05, 5, { 1, 0, 0 }, 0, 2.2 },
}

function corsac.conf(t)
  t.steps = 720
end

local function at(p, x, y, z)
  return { p[1] + x, p[2] + y, p[3] + z }
end

function corsac.load()
  scene.spawn{ position = { 0, -0.5, 0 }, mesh = "box", color = { 0.3, 0.33, 0.3 },
    body = { type = "static", shape = "box", size = { 30, 1, 30 } } }
  for i = 0, n - 1 do
    local x, y, z = 1.7 * (i % 2) - 0.8, 0.3 + 1.9 * math.floor(i / 4), 0.6 * (math.floor(i / 2) % 2)
    local bones = {}
    for k, p in ipairs(parts) do
      bones[k] = { parent = p[1], head = at(p[2], x, y, z), tail = at(p[3], x, y, z),
        radius = p[4], mass = p[5], axis = p[6], lower = p[7], upper = p[8] }
    end
    local bodies, joints = phys.newRagdoll{ bones = bones }
    dolls[#dolls + 1] = { bodies = bodies, joints = joints }
  end
  gfx.setBackground(0.025, 0.03, 0.045)
  gfx.setAmbient(0.2, 0.22, 0.26)
  gfx.newLight{ type = "directional", direction = { -0.5, -1, -0.6 }, intensity = 2.8 }
  gfx.setCamera{ position = { 2, 3, 8 }, target = { 0, 0.8, 0 }, fov = 0.9, far = 200 }
end

function corsac.fixed()
  steps = steps + 1
  local fastest, farthest, bent = 0, 0, 0
  for _, doll in ipairs(dolls) do
    for _, body in ipairs(doll.bodies) do
      local vx, vy, vz = body:getVelocity()
      local x, _, z = body:getPosition()
      fastest = math.max(fastest, math.sqrt(vx * vx + vy * vy + vz * vz))
      farthest = math.max(farthest, math.abs(x), math.abs(z))
    end
    for k = 9, 11, 2 do
      bent = math.min(bent, doll.joints[k]:getValue())
    end
  end
  if steps > 60 then
    corsac.metrics.set("fastest_m_s", fastest)
  end
  corsac.metrics.set("farthest_m", farthest)
  corsac.metrics.set("knees_rad", bent)
end

local function rotated(body, x, y, z)
  local qx, qy, qz, qw = body:getRotation()
  local ux, uy, uz = 2 * (qy * z - qz * y), 2 * (qz * x - qx * z), 2 * (qx * y - qy * x)
  return x + qw * ux + qy * uz - qz * uy, y + qw * uy + qz * ux - qx * uz,
    z + qw * uz + qx * uy - qy * ux
end

function corsac.draw()
  for i, doll in ipairs(dolls) do
    local color = { 0.4 + 0.5 * ((i * 7) % 5) / 5, 0.5, 0.3 + 0.6 * ((i * 3) % 7) / 7 }
    for k, p in ipairs(parts) do
      local x, y, z = doll.bodies[k]:getPosition()
      local dx, dy, dz = rotated(doll.bodies[k], p[3][1] - p[2][1], p[3][2] - p[2][2],
        p[3][3] - p[2][3])
      gfx.drawCapsule({ x, y, z }, { x + dx, y + dy, z + dz }, p[4], { color = color })
    end
  end
end

corsac.expect("user.fastest_m_s", "<=", 0.7)
corsac.expect("user.farthest_m", "<=", 8)
corsac.expect("user.knees_rad", ">=", -0.05)
corsac.expect("accuracy.joint_error_max_m", "<=", 0.02)
