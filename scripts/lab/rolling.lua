-- SimBenchmark "rolling" (Kang and Hwangbo 2018): 25 balls of 1 kg lie on a slab of 10 kg that 150 N
-- pull along x for 4 s; friction 0.4 between slab and ground, 0.8 between ball and slab. The slab
-- slides and the balls roll, so that with m balls of mass 1 kg, 7/2 of the usual inertia argument gives
--   a = (F - 0.4 (10 + 25) g) / (10 + 25 * 2/7),   slab a t,   ball 2/7 a t.
local scene, phys = corsac.scene, corsac.phys
local slab
local balls = {}
local squares, samples = 0, 0
local g = 9.81
local a = (150 - 0.4 * 35 * g) / (10 + 25 * 2 / 7)

-- Friction of a pair is the root of the product: 0.2 * 0.8 = 0.4^2 and 0.8 * 0.8 = 0.8^2.
function corsac.load()
    phys.setGravity(0, -g, 0)
    scene.spawn{
        position = { 0, -0.5, 0 },
        body = { type = "static", shape = "box", size = { 200, 1, 200 }, friction = 0.2 },
    }
    slab = scene.spawn{
        position = { 0, 0.5, 0 }, mesh = "box",
        body = { shape = "box", size = { 20, 1, 20 }, density = 10 / 400, friction = 0.8 },
    }
    for i = 0, 24 do
        balls[i + 1] = scene.spawn{
            position = { 2 * (i % 5 - 2), 1.5, 2 * (math.floor(i / 5) - 2) }, mesh = "sphere",
            body = { shape = "sphere", radius = 0.5, density = 6 / math.pi, friction = 0.8 },
        }
    end
end

local function add(object, speed)
    local x, y, z = object:getBody():getVelocity()
    squares = squares + (x - speed) ^ 2 + y * y + z * z
    samples = samples + 1
end

function corsac.fixed()
    local t = corsac.getTime()
    add(slab, a * t)
    for _, ball in ipairs(balls) do add(ball, 2 / 7 * a * t) end
    slab:getBody():applyForce(150, 0, 0)
end

function corsac.quit()
    corsac.metrics.set("velocity_error", math.sqrt(squares / samples))
end
