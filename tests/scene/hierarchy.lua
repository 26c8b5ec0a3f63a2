-- args: --steps 30
-- Children follow their parents, bodies lead their entities, and names find them again.
local scene = corsac.scene

function corsac.load()
  local mast = scene.spawn{ name = "mast", position = { 10, 0, 0 } }
  local arm = scene.spawn{ name = "arm", position = { 1, 0, 0 }, parent = mast }
  scene.spawn{ name = "lamp", position = { 0, 0, 2 }, parent = arm }
  scene.spawn{ name = "ball", position = { 0, 10, 0 }, body = { shape = "sphere", radius = 0.5 } }
  scene.spawn{ name = "rider", position = { 0, 2, 0 }, parent = scene.find("ball") }
end

function corsac.fixed()
  local mast, lamp, ball, rider = scene.find("mast"), scene.find("lamp"), scene.find("ball"), scene.find("rider")
  if corsac.getStep() == 5 then
    mast:setRotation(0, math.sin(math.pi / 4), 0, math.cos(math.pi / 4))
  end
  local x, y, z = lamp:getPosition()
  if corsac.getStep() < 5 then
    corsac.metrics.set("before", math.abs(x - 11) + math.abs(y) + math.abs(z - 2))
  elseif corsac.getStep() > 6 then
    corsac.metrics.set("after", math.abs(x - 12) + math.abs(y) + math.abs(z + 1))
  end
  local _, by = ball:getPosition()
  local _, ry = rider:getPosition()
  corsac.metrics.set("ride", ry - by)
  corsac.metrics.set("height", by)
end

corsac.expect("user.before", "<=", 1e-5)
corsac.expect("user.after", "<=", 1e-5)
corsac.expect("user.ride", ">=", 1.9999)
corsac.expect("user.ride", "<=", 2.0001)
corsac.expect("user.height", "<", 9)
corsac.expect("counts.entities", "==", 5)
