-- A cloth of n by n balls on rods of 0.1 m along warp, weft and diagonals, level at first, held at two
-- corners.
local phys, scene = corsac.phys, corsac.scene
local n = corsac.param("n", 24)
local rods, balls = {}, {}
local worst = 0

local function at(i, k) return balls[i * n + k] end

function corsac.load()
    phys.setCollisionRule("cloth", "cloth", false)
    for i = 0, n - 1 do
        for k = 0, n - 1 do
            local pinned = i == 0 and (k == 0 or k == n - 1)
            balls[i * n + k] = scene.spawn{
                position = { 0.1 * k, 0, 0.1 * i }, mesh = "sphere", color = { 0.8, 0.4, 0.3 },
                body = {
                    type = pinned and "static" or "dynamic", shape = "sphere", radius = 0.04,
                    layer = "cloth",
                },
            }
            local function tie(a, length)
                if not (pinned and i == 0 and a == at(0, 0)) then
                    phys.newJoint{
                        type = "distance", a = a:getBody(), b = at(i, k):getBody(),
                        anchor = { a:getPosition() }, anchorB = { at(i, k):getPosition() },
                    }
                    rods[#rods + 1] = { a, at(i, k), length }
                end
            end
            if k > 0 then tie(at(i, k - 1), 0.1) end
            if i > 0 then tie(at(i - 1, k), 0.1) end
            if i > 0 and k > 0 then tie(at(i - 1, k - 1), 0.1 * math.sqrt(2)) end
            if i > 0 and k < n - 1 then tie(at(i - 1, k + 1), 0.1 * math.sqrt(2)) end
        end
    end
    corsac.gfx.setAmbient(0.3, 0.3, 0.35)
    corsac.gfx.setCamera{ position = { 0.05 * n, 0.5, 0.5 * n }, target = { 0.05 * n, -0.05 * n, 0 } }
end

-- Mean error of the rods, every tenth step.
local step = 0
function corsac.fixed()
    step = step + 1
    if step % 10 ~= 0 then return end
    local sum = 0
    for i = 1, #rods do
        local ax, ay, az = rods[i][1]:getPosition()
        local bx, by, bz = rods[i][2]:getPosition()
        local length = math.sqrt((ax - bx) ^ 2 + (ay - by) ^ 2 + (az - bz) ^ 2)
        sum = sum + math.abs(length - rods[i][3]) / rods[i][3]
    end
    worst = math.max(worst, sum / #rods)
end

function corsac.quit() corsac.metrics.set("stretch", 100 * worst) end
