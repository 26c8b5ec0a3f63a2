-- A plank bridge between two banks whose joints bear a stated force. The load in its middle grows
-- heavier, by gravity that rises from 0, until the bridge breaks: at the weight that statics says.
local phys, scene, gfx = corsac.phys, corsac.scene, corsac.gfx
local planks, span, sag = 12, 0.5, 0.5
local bears = 4000 -- N, of a joint
local load_mass = 200 -- kg
local pull, broken_at = 0, nil

function corsac.conf(t)
  t.steps = 900
end

local function on_break()
  broken_at = broken_at or pull
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
    if i == planks / 2 then
      local load = scene.spawn{ position = { ax, ay, 0 }, mesh = "sphere",
        color = { 0.3, 0.4, 0.9 }, body = { shape = "sphere", radius = 0.5, layer = "bridge",
          density = load_mass / (math.pi / 6) } }
      phys.newJoint{ type = "ball", a = last, b = load:getBody(), anchor = { ax, ay, 0 } }
    end
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

-- Both halves are straight and bear (load + own weight) / (2 sin of their slope) at the bank.
function corsac.fixed()
  if not broken_at then
    pull = pull + 0.012
    phys.setGravity(0, -pull, 0)
  end
  local own = planks * 40 * span * 0.05
  local rise = math.sin(math.atan2(sag, planks / 2 * span))
  local stated = 2 * bears * rise / (load_mass + own)
  corsac.metrics.set("breaks_at_over_stated", (broken_at or 0) / stated)
  corsac.metrics.set("joints_left", phys.getJointCount())
end

corsac.expect("user.breaks_at_over_stated", ">=", 0.9)
corsac.expect("user.breaks_at_over_stated", "<=", 1.1)
corsac.expect("user.joints_left", "<=", planks)
