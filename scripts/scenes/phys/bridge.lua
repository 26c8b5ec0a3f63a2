-- A plank bridge between two banks, its planks joined by rods that bear a stated force. A load in
-- its middle grows slowly until the bridge breaks.
local phys, scene, gfx = corsac.phys, corsac.scene, corsac.gfx
local planks, span, sag = 12, 0.5, 0.5
local bears = 4000 -- N, of a joint
local weight, broken_at, middle, joints = 0, nil, nil, 0

function corsac.conf(t)
  t.steps = 900
end

local function on_break()
  broken_at = broken_at or weight
end

-- A shallow V: the middle hangs sag below the banks, so that statics say what a joint bears.
local function point(i)
  local half = planks / 2
  return (i - half) * span, -sag * (1 - math.abs(i - half) / half)
end

function corsac.load()
  phys.setCollisionRule("bridge", "bridge", false)
  local last
  for i = 0, planks - 1 do
    local ax, ay = point(i)
    local bx, by = point(i + 1)
    local plank = scene.spawn{ position = { (ax + bx) / 2, (ay + by) / 2, 0 }, mesh = "box",
      rotation = { axis = { 0, 0, 1 }, angle = math.atan2(by - ay, bx - ax) },
      color = { 0.7, 0.5 + 0.1 * (i % 2), 0.3 },
      body = { shape = "box", size = { span, 0.05, 1 }, density = 40, layer = "bridge",
        linearDamping = 4, angularDamping = 4 } }
    phys.newJoint{ type = "ball", a = last, b = plank:getBody(), anchor = { ax, ay, 0 },
      breakForce = bears, onBreak = on_break }
    last = plank:getBody()
    middle = i == planks / 2 and last or middle
  end
  local x, y = point(planks)
  phys.newJoint{ type = "ball", a = last, anchor = { x, y, 0 }, breakForce = bears,
    onBreak = on_break }
  for side = -1, 1, 2 do
    scene.spawn{ position = { side * (planks * span / 2 + 2), -1, 0 }, mesh = "box",
      color = { 0.42, 0.45, 0.52 },
      body = { type = "static", shape = "box", size = { 4, 1.9, 3 }, layer = "bridge" } }
  end
  gfx.setBackground(0.025, 0.03, 0.045)
  gfx.setAmbient(0.2, 0.22, 0.26)
  gfx.newLight{ type = "directional", direction = { -0.5, -1, -0.6 }, intensity = 2.8 }
  gfx.setCamera{ position = { 1, 2, 8 }, target = { 0, -0.5, 0 }, fov = 0.9, far = 200 }
end

-- The load hangs at the left end of the middle plank. Two straight halves: each bears
-- (load + own weight / 2) / (2 sin a) at the bank in the pull along the planks.
function corsac.fixed()
  joints = phys.getJointCount()
  if not broken_at then
    weight = weight + 4
    local _, y = middle:getPosition()
    middle:applyImpulse(0, -weight * corsac.getDt(), 0, 0, y, 0)
  end
  local own = planks * 40 * span * 0.05 * 9.81
  local rise = math.sin(math.atan2(sag, planks / 2 * span))
  local stated = 2 * bears * rise - own
  corsac.metrics.set("breaks_at_over_stated", (broken_at or 0) / stated)
  corsac.metrics.set("joints_left", joints)
end

corsac.expect("user.breaks_at_over_stated", ">=", 0.9)
corsac.expect("user.breaks_at_over_stated", "<=", 1.1)
corsac.expect("user.joints_left", "<=", planks)
