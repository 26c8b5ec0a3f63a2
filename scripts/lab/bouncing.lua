-- SimBenchmark "bouncing" (Kang and Hwangbo 2018): 25 balls fall from 1 to 4 m onto the ground and
-- bounce without loss. The energy of each must stay what it was.
local restitution = corsac.param("restitution", 1)
local g = 9.81
local balls, start = {}, {}
local squares, samples = 0, 0

local function energy(ball)
    local _, y = ball:getPosition()
    local vx, vy, vz = ball:getBody():getVelocity()
    return g * (y - 0.5) + (vx * vx + vy * vy + vz * vz) / 2
end

function corsac.load()
    corsac.phys.setGravity(0, -g, 0)
    corsac.scene.spawn{
        position = { 0, -0.5, 0 },
        body = {
            type = "static", shape = "box", size = { 100, 1, 100 }, friction = 0,
            restitution = restitution,
        },
    }
    for i = 0, 24 do
        balls[i + 1] = corsac.scene.spawn{
            position = { 2 * (i % 5), 1.5 + i / 8, 2 * math.floor(i / 5) }, mesh = "sphere",
            body = {
                shape = "sphere", radius = 0.5, density = 1000, friction = 0,
                restitution = restitution,
            },
        }
        start[i + 1] = energy(balls[i + 1])
    end
end

function corsac.fixed()
    for i, ball in ipairs(balls) do
        squares = squares + (energy(ball) / start[i] - 1) ^ 2
        samples = samples + 1
    end
end

function corsac.quit()
    corsac.metrics.set("energy_error", math.sqrt(squares / samples))
end
