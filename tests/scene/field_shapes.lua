-- Fields and triggers in the form of a capsule and of a cylinder that lies: they act inside only.
-- args: --steps 60
local phys = corsac.phys
local inside, above, aside, entered = nil, nil, nil, 0

local function ball(x, y, z)
  return phys.newBody{ shape = "sphere", radius = 0.1, position = { x, y, z } }
end

function corsac.load()
  phys.setGravity(0, 0, 0)
  phys.newField{ acceleration = { 0, 2, 0 }, shape = "cylinder", radius = 1, height = 20,
    rotation = { axis = { 0, 0, 1 }, angle = math.pi / 2 } } -- along x
  phys.newTrigger{ shape = "capsule", radius = 0.5, height = 4, position = { 0, 0, 5 },
    onEnter = function() entered = entered + 1 end }
  inside, above, aside = ball(9, -0.9, 0), ball(9, 1.2, 0), ball(11, 0, 0)
  ball(0, 2.4, 5) -- in the capsule's cap
  ball(0, 2.7, 5)
  ball(0.5, 0, 5)
end

function corsac.fixed()
  corsac.metrics.set("inside", (select(2, inside:getPosition())))
  corsac.metrics.set("above", (select(2, above:getPosition())))
  corsac.metrics.set("aside", (select(2, aside:getPosition())))
  corsac.metrics.set("entered", entered)
end

corsac.expect("user.inside", ">=", 0.05) -- 2 m/s^2 for 1 s
corsac.expect("user.inside", "<=", 0.15)
corsac.expect("user.above", "==", 1.2000000476837158)
corsac.expect("user.aside", "==", 0)
corsac.expect("user.entered", "==", 2)
