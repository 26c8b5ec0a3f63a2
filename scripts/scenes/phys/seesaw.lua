-- A see-saw on a hinge with limits: twice the mass at half the arm balances, then a third child
-- tips it to its stop.
local phys, scene, gfx = corsac.phys, corsac.scene, corsac.gfx
local hinge, steps = nil, 0

function corsac.conf(t)
  t.steps = 420
end

local function seat(board, x, mass)
  local size = 0.3
  local box = scene.spawn{ position = { x, 1.2, 0 }, mesh = "box", color = { 0.9, 0.4, 0.3 },
    body = { shape = "box", size = { size, size, size }, density = mass / size ^ 3 } }
  phys.newJoint{ type = "fixed", a = board, b = box:getBody(), anchor = { x, 1.05, 0 } }
end

local board
function corsac.load()
  board = scene.spawn{ position = { 0, 1, 0 }, mesh = "box", color = { 0.7, 0.6, 0.4 },
    body = { shape = "box", size = { 4, 0.1, 0.5 } } }:getBody()
  hinge = phys.newJoint{ type = "revolute", b = board, anchor = { 0, 1.2, 0 }, axis = { 0, 0, 1 },
    lower = -0.3, upper = 0.3 }
  seat(board, -0.9, 40)
  seat(board, 1.8, 20)
  gfx.setBackground(0.025, 0.03, 0.045)
  gfx.setAmbient(0.2, 0.22, 0.26)
  gfx.newLight{ type = "directional", direction = { -0.5, -1, -0.6 }, intensity = 2.8 }
  gfx.setCamera{ position = { 1, 3, 7 }, target = { 0, 1, 0 }, fov = 0.9, far = 200 }
end

function corsac.fixed()
  steps = steps + 1
  if steps == 180 then
    corsac.metrics.set("balance_rad", math.abs(hinge:getValue()))
    seat(board, 1.4, 30)
  end
  corsac.metrics.set("angle_rad", hinge:getValue())
end

corsac.expect("user.balance_rad", "<=", 0.001)
corsac.expect("user.angle_rad", ">=", -0.301)
corsac.expect("user.angle_rad", "<=", -0.299)
corsac.expect("accuracy.joint_error_max_m", "<=", 0.001)
