-- A rod of edges 1 x 0.1 x 0.05 m without gravity, turning about its middle axis, which is unstable, at
-- `spin` rad/s with a nudge of 1 %. Without torque its energy stays. Rods are the hardest shape: their
-- principal moments differ most.
local spin = corsac.param("spin", 10)
local size = { 1, 0.1, 0.05 }
local inertia = { 0.0125, 1.0025, 1.01 } -- times mass / 12
local brick
local worst, first = 0, nil

-- Vector into the body's axes: by the conjugate of its rotation.
local function toBody(x, y, z)
    local qx, qy, qz, qw = brick:getBody():getRotation()
    qx, qy, qz = -qx, -qy, -qz
    local tx, ty, tz = 2 * (qy * z - qz * y), 2 * (qz * x - qx * z), 2 * (qx * y - qy * x)
    return x + qw * tx + qy * tz - qz * ty, y + qw * ty + qz * tx - qx * tz,
        z + qw * tz + qx * ty - qy * tx
end

local function energy()
    local x, y, z = toBody(brick:getBody():getAngularVelocity())
    return inertia[1] * x * x + inertia[2] * y * y + inertia[3] * z * z
end

function corsac.load()
    corsac.phys.setGravity(0, 0, 0)
    brick = corsac.scene.spawn{
        mesh = "box",
        body = { shape = "box", size = size, angularVelocity = { 0.01 * spin, spin, 0.01 * spin } },
    }
    first = energy()
end

function corsac.fixed()
    worst = math.max(worst, math.abs(energy() / first - 1))
end

function corsac.quit()
    corsac.metrics.set("spin_energy_error", worst)
end
