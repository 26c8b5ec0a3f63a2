-- Lab: n agents cross a square of 12 m, each to the opposite side of its edge: how many arrive, how
-- deep they overlap.
local n = corsac.param("n", 40)
local nav = corsac.nav
local agents, worst, side = {}, 0, 12

function corsac.load()
    local ground = { position = { 0, -0.5, 0 }, size = { side + 4, 1, side + 4 } }
    local surface = nav.newSurface{ boxes = { ground }, cellSize = 0.25 }
    for i = 1, n do -- along a spiral from the border inwards, the goal at the other end
        local t = (i - 0.5) / n
        local a, r = 2.399963 * i, 0.5 * side * math.sqrt(t)
        local x, z = r * math.cos(a), r * math.sin(a)
        agents[i] = nav.newAgent{ position = { x, 0, z } }
        agents[i]:cross(surface, -x, 0, -z)
    end
end

function corsac.fixed()
    local arrived, px, pz = 0, {}, {}
    for i, agent in ipairs(agents) do
        local _
        px[i], _, pz[i] = agent:getPosition()
        arrived = arrived + (agent:getState() == "arrived" and 1 or 0)
    end
    if corsac.getStep() % 10 == 0 and corsac.getStep() > 60 then
        for i = 1, n do
            for k = 1, i - 1 do
                local dx, dz = px[i] - px[k], pz[i] - pz[k]
                worst = math.max(worst, 0.6 - math.sqrt(dx * dx + dz * dz))
            end
        end
    end
    corsac.metrics.set("missing", (n - arrived) / n)
    corsac.metrics.set("overlap", worst / 0.3)
end
