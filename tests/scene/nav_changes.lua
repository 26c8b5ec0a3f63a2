-- args: --steps 240
-- Surfaces that change: pieces, marks, links, files, and one made from the bodies of the world that
-- follows them; each is asked for ways whose lengths are known.
local nav, scene = corsac.nav, corsac.scene
local near = function(a, b, by) return math.abs(a - b) <= (by or 0.05) end
local fine, world, door, wall = 0, nil, nil, nil
local function check(good, what)
    assert(good, what)
    fine = fine + 1
end
local function length(surface, a, b, options)
    local _, cost, status = surface:findPath(a, b, options)
    return cost, status
end

local function pieces()
    local s = nav.newSurface{ low = { 0, 0, 0 }, high = { 20, 0, 20 }, tileCells = 16, cellSize = 0.25 }
    check(s:getArea() == 0, "empty")
    s:put(1, { boxes = { { position = { 10, -0.5, 10 }, size = { 20, 1, 20 } } } })
    check(s:getWaiting() > 0, "waits")
    s:update()
    check(s:getWaiting() == 0 and s:getArea() > 350, "made")
    check(near(length(s, { 2, 0, 10 }, { 18, 0, 10 }), 16), "straight")
    s:put(2, { boxes = { { position = { 10, 1, 9 }, size = { 1, 2, 18 } } } })
    s:update()
    check(near(length(s, { 2, 0, 10 }, { 18, 0, 10 }), 2 * math.sqrt(7.25 ^ 2 + 8.4 ^ 2) + 1.5, 0.6), "round")
    s:remove(2)
    s:mark(3, { position = { 10, 0, 10 }, size = { 2, 1, 20 }, area = 4 })
    s:update()
    check(near(length(s, { 2, 0, 10 }, { 18, 0, 10 }), 16), "an area costs nothing by itself")
    check(near(length(s, { 2, 0, 10 }, { 18, 0, 10 }, { costs = { 0, 0, 0, 0, 3 } }), 20, 0.3), "mud")
    local cost, status = length(s, { 2, 0, 10 }, { 18, 0, 10 }, { costs = { 0, 0, 0, 0, -1 } })
    check(cost == 0 and status == "no path", "closed")
    cost, status = length(s, { 2, 0, 10 }, { 18, 0, 10 }, { costs = { 0, 0, 0, 0, -1 }, partial = true })
    check(near(cost, 7, 0.3) and status == "partial", "in part")
    s:mark(3, { position = { 10, 0, 10 }, size = { 2, 1, 20 }, area = 255 })
    s:update()
    local link = s:addLink{ from = { 8, 0, 10 }, to = { 12, 0, 10 }, cost = 1, kind = "ladder" }
    local points
    points, cost = s:findPath({ 2, 0, 10 }, { 18, 0, 10 })
    check(near(cost, 13) and #points == 4 and points[2].link == link and not points[1].link, "link")
    local about = s:getLink(link)
    check(about.kind == "ladder" and about.open and not about.bothWays and about.to[1] == 12, "about")
    s:setLinkOpen(link, false)
    check(select(2, length(s, { 2, 0, 10 }, { 18, 0, 10 })) == "no path", "shut")
    s:setLinkOpen(link, true)
    s:save("level.cnav")
    local again = nav.loadSurface("level.cnav")
    check(again:getArea() == s:getArea() and near(length(again, { 2, 0, 10 }, { 18, 0, 10 }), 13), "file")
    check(not pcall(nav.loadSurface, "none.cnav"), "no file")
    s:removeLink(link)
    check(not pcall(s.removeLink, s, link), "gone")
end

function corsac.load()
    pieces()
    scene.spawn{ position = { 0, -0.5, 0 }, body = { type = "static", shape = "box", size = { 20, 1, 20 } } }
    scene.spawn{ position = { 0, 1, -5.5 }, body = { type = "static", shape = "box", size = { 0.5, 2, 9 } } }
    wall = scene.spawn{ position = { 0, 1, 5.5 }, body = { type = "static", shape = "box", size = { 0.5, 2, 9 } } }
    door = scene.spawn{ position = { 0, 1, 0 }, body = { type = "kinematic", shape = "box", size = { 0.5, 2, 2 } } }
    world = nav.newSurface{ from = "physics", kinematic = true, cellSize = 0.25 }
    check(select(2, length(world, { -5, 0, 0 }, { 5, 0, 0 })) == "no path", "the door is shut")
end

function corsac.fixed()
    local step = corsac.getStep()
    if step == 10 then
        door:setPosition(0, 5, 0)
    elseif step == 60 then
        check(near(length(world, { -5, 0, 0 }, { 5, 0, 0 }), 10), "the door is open")
        door:setPosition(0, 1, 0)
    elseif step == 110 then
        check(select(2, length(world, { -5, 0, 0 }, { 5, 0, 0 })) == "no path", "shut again")
        wall:destroy()
    elseif step == 160 then
        check(near(length(world, { -5, 0, 5 }, { 5, 0, 5 }), 10), "no wall")
        scene.spawn{ position = { 0, 1, 5.5 }, body = { type = "static", shape = "box", size = { 0.5, 2, 9 } } }
    elseif step == 210 then
        check(select(2, length(world, { -5, 0, 5 }, { 5, 0, 5 })) == "no path", "a wall")
    end
    corsac.metrics.set("fine", fine)
end
corsac.expect("user.fine", "==", 20)
