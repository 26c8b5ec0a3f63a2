-- A ball of radius 0.05 m, or a cube of that half width, shot at a wall of some thickness at some
-- speed; whether it came through. The first distance differs from shot to shot, so that no step size
-- is lucky.
local speed = corsac.param("speed", 50)
local thick = corsac.param("thick", 0.1) -- m
local box = corsac.param("box", false)
local free = corsac.param("free", false) -- the wall is a free plate, a thousand times heavier
local balls = {}
local wall

function corsac.load()
    corsac.phys.setGravity(0, 0, 0)
    wall = corsac.scene.spawn{
        position = { 0, 0, 0 }, mesh = "box",
        body = {
            type = free and "dynamic" or "static", shape = "box", size = { thick, 20, 4 },
            density = 4.2 / (80 * thick),
        },
    }
    for i = 1, 8 do
        balls[i] = corsac.scene.spawn{
            position = { -0.6 - thick / 2 - speed / 60 * (i / 8), i - 4.5, 0 }, mesh = "sphere",
            body = {
                shape = box and "box" or "sphere", radius = not box and 0.05 or nil,
                size = box and { 0.1, 0.1, 0.1 } or nil, density = 1, velocity = { speed, 0, 0 },
            },
        }
    end
end

function corsac.quit()
    local through = 0
    local wallX = wall:getPosition()
    for _, ball in ipairs(balls) do
        if ball:getPosition() > wallX then through = through + 1 end
    end
    corsac.metrics.set("through", through)
end
