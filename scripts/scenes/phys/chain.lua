-- A chain of fifty links with a ball of a hundred times a link's mass at its end, let go level.
-- n: links. ratio: mass of the ball over that of a link.
local phys, scene, gfx = corsac.phys, corsac.scene, corsac.gfx
local n, ratio = corsac.param("n", 50), corsac.param("ratio", 100)

function corsac.conf(t)
  t.steps = 600
end

function corsac.load()
  phys.setCollisionRule("chain", "chain", false)
  local last
  local function hang(x, body)
    phys.newJoint{ type = "ball", a = last, b = body, anchor = { x, 0, 0 } }
    last = body
  end
  for i = 0, n - 1 do
    local link = scene.spawn{ position = { 0.4 * i + 0.2, 0, 0 }, mesh = "box",
      color = { 0.9, 0.5 + 0.2 * (i % 2), 0.3 },
      body = { shape = "box", size = { 0.4, 0.1, 0.1 }, layer = "chain" } }
    hang(0.4 * i, link:getBody())
  end
  local density = 4 * ratio / (4 / 3 * math.pi * 0.3 ^ 3)
  local ball = scene.spawn{ position = { 0.4 * n + 0.3, 0, 0 }, mesh = "sphere",
    color = { 0.3, 0.5, 0.9 },
    body = { shape = "sphere", radius = 0.3, density = density, layer = "chain" } }
  hang(0.4 * n, ball:getBody())
  gfx.setBackground(0.025, 0.03, 0.045)
  gfx.setAmbient(0.2, 0.22, 0.26)
  gfx.newLight{ type = "directional", direction = { -0.5, -1, -0.6 }, intensity = 2.8 }
  gfx.setCamera{ position = { 4, -6, 34 }, target = { 4, -9, 0 }, fov = 0.9, far = 200 }
end

corsac.expect("counts.joints", "==", n + 1)
corsac.expect("accuracy.joint_error_max_m_peak", "<=", 0.02)
corsac.expect("accuracy.nan", "==", 0)
