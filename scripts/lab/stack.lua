-- A stack of n unit cubes; the top one may be heavier, each may be shifted sideways. The exact height
-- of the top is n - 0.5 m.
local n = corsac.param("n", 10)
local ratio = corsac.param("ratio", 1) -- mass of the top cube against the others
local shift = corsac.param("shift", 0) -- m, to alternating sides
local scene = corsac.scene
local cubes = {}

function corsac.load()
    scene.spawn{
        position = { 0, -0.5, 0 }, mesh = "box", color = { 0.42, 0.45, 0.52 },
        body = { type = "static", shape = "box", size = { 40, 1, 40 } },
    }
    for i = 1, n do
        cubes[i] = scene.spawn{
            position = { i % 2 == 0 and shift or 0, i - 0.5, 0 }, mesh = "box",
            color = i % 2 == 0 and { 0.95, 0.62, 0.24 } or { 0.36, 0.62, 0.68 },
            body = {
                shape = "box", size = { 1, 1, 1 }, density = i == n and 1000 * ratio or 1000,
                friction = 0.5,
            },
        }
    end
    corsac.gfx.setAmbient(0.3, 0.3, 0.35)
    corsac.gfx.newLight{ type = "directional", direction = { -0.5, -1, -0.6 }, intensity = 2.5 }
    corsac.gfx.setCamera{ position = { n, n, 1.6 * n }, target = { 0, n / 2, 0 }, far = 20 * n + 60 }
end

function corsac.quit()
    local drift, speed = 0, 0
    for i, cube in ipairs(cubes) do
        local x, _, z = cube:getPosition()
        local vx, vy, vz = cube:getBody():getVelocity()
        local dx = x - (i % 2 == 0 and shift or 0)
        drift = math.max(drift, math.sqrt(dx * dx + z * z))
        speed = math.max(speed, math.sqrt(vx * vx + vy * vy + vz * vz))
    end
    local _, top = cubes[n]:getPosition()
    local sag = n - 0.5 - top
    corsac.metrics.set("sag_mm", 1000 * math.abs(sag))
    corsac.metrics.set("drift_mm", 1000 * drift)
    corsac.metrics.set("speed_mm_s", 1000 * speed)
    corsac.metrics.set("fell", (sag > 0.5 or drift > 0.5) and 1 or 0)
end
