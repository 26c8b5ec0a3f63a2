-- A mass of 1 kg on a distance joint with a spring of `hertz`, pulled 0.1 m; no damping but the
-- method's own. User metric `swing`: largest way from rest in the last quarter over that at first.
local hertz = corsac.param("hertz", 5)
local mass
local ways = {}

function corsac.load()
    corsac.phys.setGravity(0, 0, 0)
    mass = corsac.scene.spawn{
        position = { 1.1, 0, 0 }, mesh = "sphere",
        body = { shape = "sphere", radius = 0.1, density = 1 / (4 / 3 * math.pi * 0.001) },
    }
    corsac.phys.newJoint{
        type = "distance", b = mass:getBody(), anchor = { 0, 0, 0 }, anchorB = { 1.1, 0, 0 },
        hertz = hertz, dampingRatio = 0, rest = 1,
    }
end

function corsac.fixed()
    local x = mass:getPosition()
    ways[#ways + 1] = math.abs(x - 1)
end

function corsac.quit()
    local largest = 0
    for i = math.floor(0.75 * #ways) + 1, #ways do largest = math.max(largest, ways[i]) end
    corsac.metrics.set("swing", largest / 0.1)
end
