-- Lab: a flight of stairs at an angle: does a mover led by an agent get to the top, where the surface
-- says it can? `rise` and `run` of a step in metres.
local rise, run = corsac.param("rise", 0.2), corsac.param("run", 0.3)
local nav, scene, phys = corsac.nav, corsac.scene, corsac.phys
local mover, found, top = nil, false, 0

function corsac.load()
    local function box(x, y, wide, high)
        scene.spawn{ position = { x, y, 0 }, body = { type = "static", shape = "box", size = { wide, high, 4 } } }
    end
    box(-4, -0.5, 8, 1)
    local steps = math.max(2, math.floor(1.8 / rise))
    for i = 1, steps do box(run * (i - 0.5), rise * i / 2, run, rise * i) end
    top = rise * steps
    box(run * steps + 3, top / 2, 6, top)
    local surface = nav.newSurface{ from = "physics", cellSize = 0.1, climb = 0.3 }
    mover = phys.newMover{ position = { -4, 0.9, 0 }, stepHeight = 0.3 }
    local agent = nav.newAgent{ mover = mover, offset = 0.9 }
    found = surface:findPath({ -4, 0, 0 }, { run * steps + 3, top, 0 }) ~= nil
    agent:cross(surface, run * steps + 3, top, 0)
end

function corsac.fixed()
    local _, y = mover:getPosition()
    local up = y - 0.9 > top - 0.1
    corsac.metrics.set("low", up and 0 or 1)
    corsac.metrics.set("promised", found and not up and 1 or 0)
end
