-- sick: stack height
-- A stack of 12 cubes that somebody made cheap: one sub-step.
function corsac.conf(t) t.phys = { substeps = 1 } end

function corsac.load()
    corsac.scene.spawn{
        position = { 0, -0.5, 0 }, mesh = "box",
        body = { type = "static", shape = "box", size = { 40, 1, 40 } },
    }
    for i = 1, 12 do
        corsac.scene.spawn{
            position = { 0, i - 0.5, 0 }, mesh = "box",
            body = { shape = "box", size = { 1, 1, 1 } },
        }
    end
end
