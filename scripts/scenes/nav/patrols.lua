-- Guards walk their rounds on a graph of waypoints; a gate on the way shuts and opens, and they take
-- the other way round while it is shut.
local nav, scene, gfx = corsac.nav, corsac.scene, corsac.gfx
local show = corsac.param("show", false)
local graph, guards, rounds, far, open = nil, {}, 0, 0, true
local posts = { { -8, -8 }, { 8, -8 }, { 8, 8 }, { -8, 8 } }
local node = {}

local function nextPost(guard)
    guard.post = guard.post % #posts + 1
    if guard.post == guard.first then rounds = rounds + 1 end
    local p = posts[guard.post]
    guard.agent:go(graph, p[1], 0, p[2])
end

function corsac.conf(t) t.steps = 60 * 120 end

function corsac.load()
    graph = nav.newGraph{ name = "rounds" }
    for i, p in ipairs(posts) do
        node[i] = graph:add(p[1], 0, p[2])
        scene.spawn{ position = { p[1], 0.1, p[2] }, scale = { 0.6, 0.2, 0.6 }, mesh = "cylinder" }
    end
    node[5] = graph:add(0, 0, -14) -- the long way round the gate
    for i = 1, 4 do graph:connect(node[i], node[i % 4 + 1]) end
    graph:connect(node[1], node[5])
    graph:connect(node[5], node[2])
    for i = 1, 3 do
        local body = scene.spawn{
            position = { posts[i][1], 0.9, posts[i][2] }, scale = { 0.6, 0.9, 0.6 }, mesh = "capsule",
            color = { 0.3 * i, 0.6, 0.9 },
        }
        guards[i] = { post = i, first = i, agent = nav.newAgent{ entity = body, offset = 0.9, turnRate = 5 } }
        nextPost(guards[i])
    end
    scene.spawn{ position = { 0, -0.5, -2 }, scale = { 24, 1, 28 }, mesh = "box", color = { 0.3, 0.34, 0.3 } }
    gfx.setCamera{ position = { 0, 22, 18 }, target = { 0, 0, -2 } }
end

function corsac.fixed()
    if corsac.getStep() % 1500 == 750 then
        open = not open
        graph:setOpen(node[1], node[2], open)
        graph:setOpen(node[2], node[1], open)
    end
    for _, guard in ipairs(guards) do
        local _, _, z = guard.agent:getPosition()
        far = math.max(far, -z)
        if guard.agent:getState() == "arrived" then nextPost(guard) end
    end
    corsac.metrics.set("rounds", rounds)
    corsac.metrics.set("far", far)
end

function corsac.draw()
    if show then
        graph:draw(true)
        nav.drawAgents()
    end
end

corsac.expect("user.rounds", ">=", 6)
corsac.expect("user.far", ">=", 13.5) -- somebody went round the shut gate
