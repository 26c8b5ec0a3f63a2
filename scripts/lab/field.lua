-- A ball on a spring: a point field whose core (10 m) holds the ball, which starts 1 m from the centre.
-- `k` is the stiffness in 1/s^2. Without loss its energy stays.
local k = corsac.param("k", 100)
local ball
local ratio = 1

function corsac.load()
    corsac.phys.setGravity(0, 0, 0)
    corsac.phys.newField{ type = "point", center = { 0, 0, 0 }, strength = k * 1000, core = 10 }
    ball = corsac.scene.spawn{
        position = { 1, 0, 0 }, mesh = "sphere", body = { shape = "sphere", radius = 0.1 },
    }
end

function corsac.update()
    local x = ball:getPosition()
    local v = ball:getBody():getVelocity()
    ratio = math.max(ratio, x * x + v * v / k)
end

function corsac.quit()
    corsac.metrics.set("energy_ratio", math.min(ratio, 1e30))
end
