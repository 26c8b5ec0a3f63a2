-- SimBenchmark "666" and "elastic 666" (Kang and Hwangbo 2018): 6 x 6 x 6 balls of 10 kg and radius
-- 0.1 m, 0.21 m apart, each moved by up to 1 mm, no friction. Inelastic they must not overlap;
-- elastic (restitution 1, from 1 m higher) they must keep their energy.
local restitution = corsac.param("restitution", 0)
local lift = corsac.param("lift", 0) -- m
local balls = {}
local g, mass = 9.81, 10
local first

local function energy()
    local sum = 0
    for _, ball in ipairs(balls) do
        local _, y = ball:getPosition()
        local vx, vy, vz = ball:getBody():getVelocity()
        sum = sum + mass * (g * y + (vx * vx + vy * vy + vz * vz) / 2)
    end
    return sum
end

local function nudge() return 0.001 * (2 * math.random() - 1) end

function corsac.load()
    corsac.phys.setGravity(0, -g, 0)
    corsac.scene.spawn{
        position = { 0, -0.5, 0 },
        body = {
            type = "static", shape = "box", size = { 100, 1, 100 }, friction = 0,
            restitution = restitution,
        },
    }
    for i = 0, 215 do
        balls[i + 1] = corsac.scene.spawn{
            position = {
                0.21 * (i % 6) + nudge(), 0.11 + lift + 0.21 * math.floor(i / 36) + nudge(),
                0.21 * (math.floor(i / 6) % 6) + nudge(),
            },
            mesh = "sphere",
            body = {
                shape = "sphere", radius = 0.1, density = mass / (4 / 3 * math.pi * 0.001),
                friction = 0, restitution = restitution,
            },
        }
    end
    first = energy()
end

function corsac.quit()
    corsac.metrics.set("energy_error", math.abs(energy() / first - 1))
end
