-- A square cloth of n x n particles swings down from two corners: how far its edges stretch.
local n, pieces = corsac.param("n", 40), corsac.param("pieces", 8)
local cloth, steps, sum, worst = nil, 0, 0, 0

function corsac.load()
    cloth = corsac.phys.newCloth{ columns = n, rows = n, position = { -2, 0, 0 },
        across = { 4, 0, 0 }, down = { 0, 0, 4 }, substeps = pieces }
    cloth:hold(1, 1)
    cloth:hold(n, 1)
end

function corsac.fixed()
    local mean, most = cloth:getStretch()
    steps = steps + 1
    sum = sum + mean
    worst = math.max(worst, most)
    corsac.metrics.set("stretch_mean", sum / steps)
    corsac.metrics.set("stretch_most", worst)
end
