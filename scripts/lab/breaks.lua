-- A weight of `load` kg hangs on a fixed joint that bears `bears` newtons. User metric `broken`.
local bears, load = corsac.param("bears", 1000), corsac.param("load", 50)
local broken = 0

function corsac.load()
    local weight = corsac.scene.spawn{
        position = { 0, 0, 0 }, mesh = "box",
        body = { shape = "box", size = { 0.2, 0.2, 0.2 }, density = load / 0.008 },
    }
    corsac.phys.newJoint{
        type = "fixed", b = weight:getBody(), anchor = { 0, 0.1, 0 }, breakForce = bears,
        onBreak = function() broken = 1 end,
    }
end

function corsac.quit() corsac.metrics.set("broken", broken) end
