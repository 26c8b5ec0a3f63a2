-- A chain of n links of 0.4 m and 4 kg on ball joints, level at first, with a ball of `ratio` times a
-- link's mass at its end.
local phys, scene = corsac.phys, corsac.scene
local n, ratio = corsac.param("n", 50), corsac.param("ratio", 1)

function corsac.load()
    phys.setCollisionRule("chain", "chain", false)
    local last
    local function hang(x, body)
        phys.newJoint{ type = "ball", a = last, b = body, anchor = { x, 0, 0 } }
        last = body
    end
    for i = 0, n - 1 do
        local link = scene.spawn{
            position = { 0.4 * i + 0.2, 0, 0 }, mesh = "box", color = { 0.9, 0.5 + 0.2 * (i % 2), 0.3 },
            body = { shape = "box", size = { 0.4, 0.1, 0.1 }, layer = "chain" },
        }
        hang(0.4 * i, link:getBody())
    end
    local ball = scene.spawn{
        position = { 0.4 * n + 0.3, 0, 0 }, mesh = "sphere", color = { 0.3, 0.5, 0.9 },
        body = {
            shape = "sphere", radius = 0.3, density = 4 * ratio / (4 / 3 * math.pi * 0.3 ^ 3),
            layer = "chain",
        },
    }
    hang(0.4 * n, ball:getBody())
    corsac.gfx.setAmbient(0.2, 0.22, 0.26)
    corsac.gfx.newLight{ type = "directional", direction = { -0.5, -1, -0.6 }, intensity = 2.8 }
    corsac.gfx.setCamera{ position = { 4, -6, 34 }, target = { 4, -9, 0 }, far = 200 }
end
