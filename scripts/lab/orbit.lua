-- A ball on a Kepler orbit (semi-major axis 10 m, eccentricity 0.3) in a point field of 1,000 m^3/s^2,
-- from the periapsis: how far is it from where Kepler's equation puts it, and what of its energy?
local mu, a, e = 1000, 10, 0.3
local ball

function corsac.load()
    corsac.phys.setGravity(0, 0, 0)
    corsac.phys.newField{ type = "point", center = { 0, 0, 0 }, strength = mu, core = 0.1 }
    ball = corsac.scene.spawn{
        position = { a * (1 - e), 0, 0 }, mesh = "sphere",
        body = {
            shape = "sphere", radius = 0.1,
            velocity = { 0, math.sqrt(mu / a * (1 + e) / (1 - e)), 0 },
        },
    }
end

function corsac.quit()
    local mean = math.sqrt(mu / a ^ 3) * corsac.getTime()
    local anomaly = mean
    for _ = 1, 60 do
        anomaly = anomaly - (anomaly - e * math.sin(anomaly) - mean) / (1 - e * math.cos(anomaly))
    end
    local x, y = a * (math.cos(anomaly) - e), a * math.sqrt(1 - e * e) * math.sin(anomaly)
    local px, py = ball:getPosition()
    local vx, vy = ball:getBody():getVelocity()
    local energy = (vx * vx + vy * vy) / 2 - mu / math.sqrt(px * px + py * py)
    corsac.metrics.set("position_error", math.sqrt((px - x) ^ 2 + (py - y) ^ 2))
    corsac.metrics.set("energy_error", math.abs(energy * 2 * a / mu + 1))
end
