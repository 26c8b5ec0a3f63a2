-- args: --steps 3
-- Rays, sweeps, overlaps and closest points from Lua, against known distances.
local phys = corsac.phys
local wall, ball

local function near(got, want)
  assert(math.abs(got - want) < 2e-3, got .. " is not " .. want)
end

function corsac.load()
  phys.setGravity(0, 0, 0)
  wall = phys.newBody{ type = "static", shape = "box", size = { 2, 2, 2 }, position = { 6, 0, 0 } }
  ball = phys.newBody{ shape = "sphere", radius = 0.5, position = { 3, 0, 0 }, layer = "ball" }
end

function corsac.fixed()
  local body, x, _, _, nx, _, _, part = phys.rayCast(0, 0, 0, 10, 0, 0)
  assert(body == ball, tostring(body) .. " " .. tostring(x))
  near(x, 2.5)
  near(nx, -1)
  near(part, 0.25)
  body, x = phys.rayCast(0, 0, 0, 10, 0, 0, { skip = ball })
  assert(body == wall)
  near(x, 5)
  assert(phys.rayCast(0, 5, 0, 10, 0, 0) == nil)
  assert(phys.rayCast(0, 0, 0, 10, 0, 0, { layer = "ball" }) == ball)
  body, _, _, _, _, _, _, part = phys.sphereCast(0, 1, 0, 0.75, 10, 0, 0, { skip = ball })
  assert(body == wall)
  near(part, 0.425)
  local found = phys.overlapSphere(4.5, 0, 0, 1.2)
  assert(#found == 2)
  local _, _, _, _, _, _, _, distance = phys.closest(3, 2, 0, 5, { layer = "ball" })
  near(distance, 1.5)
end
