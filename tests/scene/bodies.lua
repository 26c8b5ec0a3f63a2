-- Settings of bodies from Lua: each read back as written; a saved state goes on with the same
-- places; a blow in touch is told.
-- args: --steps 90
local phys = corsac.phys
local box, ball, ground, state, then_at, hits = nil, nil, nil, nil, {}, 0

local function same(what, got, want)
  if type(want) == "number" and math.abs(got - want) > 1e-6 or type(want) ~= "number" and got ~= want then
    error(what .. " is " .. tostring(got) .. ", expected " .. tostring(want))
  end
end

local function refused(what, text, action)
  local good, why = pcall(action)
  if good or not tostring(why):find(text, 1, true) then
    error(what .. ": expected an error with '" .. text .. "', got " .. tostring(why))
  end
end

function corsac.load()
  ground = phys.newBody{ type = "static", shape = "mesh", friction = 0.5,
    points = { -9, 0, -9, 9, 0, -9, 9, 0, 9, -9, 0, 9 }, triangles = { 1, 3, 2, 1, 4, 3 } }
  box = phys.newBody{ shape = "box", size = { 1, 0.5, 1 }, position = { 0, 0.25, 0 },
    onHit = function(self, other, speed, _, ny)
      same("self", self, box)
      same("other", other, ground)
      corsac.metrics.set("hit_speed", speed)
      corsac.metrics.set("hit_down", ny)
      hits = hits + 1
    end }
  ball = phys.newBody{ shapes = { { shape = "sphere", radius = 0.3, rolling = 0.1 },
    { shape = "capsule", radius = 0.1, height = 1 } }, position = { 3, 1, 0 }, locks = "z turnX" }

  same("type", ground:getType() .. box:getType(), "staticdynamic")
  same("shape", ground:getShape() .. ball:getShape() .. ball:getShape(2), "meshspherecapsule")
  same("shapes", ball:getShapeCount(), 2)
  same("locks", ball:getLocks(), "z turnX")
  ball:setLocks("x y turnZ")
  same("locks", ball:getLocks(), "x y turnZ")
  ball:setLocks("")
  box:setDamping(0.5, 0.25)
  same("damping", select(2, box:getDamping()), 0.25)
  box:setDamping(0, 0)
  box:setGravityScale(0.5)
  same("gravity scale", box:getGravityScale(), 0.5)
  box:setGravityScale(1)
  box:setMaterial(0.4, 0.25, 0)
  same("restitution", select(2, box:getMaterial()), 0.25)
  box:setMaterial(0.5, 0, 0)
  same("rolling", select(3, ball:getMaterial()), 0.1)
  box:applyTorque(0, 10, 0)

  refused("lock", "expected words of x y z turnX turnY turnZ", function() box:setLocks("w") end)
  refused("damping", "expected 0..1e6 per second", function() box:setDamping(-1, 0) end)
  refused("material", "restitution is 2, expected 0..1", function() box:setMaterial(1, 2, 0) end)
  refused("shape", "shape 2, expected less than 2", function() ball:getShape(3) end)
  refused("mesh", "triangles[3] is 5, expected a whole number from 1 to 4", function()
    phys.newBody{ type = "static", shape = "mesh", points = { 0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 1, 1 },
      triangles = { 1, 2, 5 } }
  end)
  refused("mesh", "only static bodies can have one", function()
    phys.newBody{ shape = "mesh", points = { 0, 0, 0, 1, 0, 0, 0, 0, 1 }, triangles = { 1, 2, 3 } }
  end)
end

local steps = 0
function corsac.fixed()
  steps = steps + 1
  if steps == 20 then
    box:setVelocity(0, -4, 0)
  elseif steps == 30 then
    state = phys.saveState()
    refused("state", "expected what saveState gave", function() phys.restoreState("x") end)
  elseif steps == 60 then
    then_at = { ball:getPosition() }
    phys.restoreState(state)
  elseif steps == 90 then
    for i, value in ipairs{ ball:getPosition() } do
      same("place after a restore", value - then_at[i] == 0, true)
    end
    local extra = phys.newBody{ shape = "sphere", radius = 0.1, position = { 0, 9, 0 } }
    refused("state", "bodies or joints were made or destroyed", function() phys.restoreState(state) end)
    extra:destroy()
    corsac.metrics.set("hits", hits)
  end
end

corsac.expect("user.hits", "==", 1)
corsac.expect("user.hit_speed", ">=", 4)
corsac.expect("user.hit_speed", "<=", 4.2)
corsac.expect("user.hit_down", "<=", -0.999)
