-- sick: spin
-- A propeller at 150 rad/s in a step of 1/20 s.
function corsac.conf(t) t.dt = 0.05 end

function corsac.load()
    corsac.phys.setGravity(0, 0, 0)
    corsac.scene.spawn{
        mesh = "box", name = "propeller",
        body = { shape = "box", size = { 2, 0.2, 0.1 }, angularVelocity = { 1, 1, 150 } },
    }
end
