-- args: --steps 30
-- Grids and flows from Lua, and debug drawing.
local nav = corsac.nav
local near = function(a, b) return math.abs(a - b) <= 1e-4 end

function corsac.load()
    local g = nav.newGrid(10, 6)
    local w, h = g:getSize()
    assert(w == 10 and h == 6)
    for y = 1, 5 do g:setBlocked(5, y, true) end
    assert(g:isBlocked(5, 3) and not g:isBlocked(5, 6) and not g:isBlocked(4, 3))
    for _, method in ipairs{ "jump", "astar" } do
        local cells, length = g:findPath(1, 1, 10, 1, { method = method })
        assert(near(length, 5 + 7 * math.sqrt(2)), method .. ": " .. length)
        assert(cells[1][1] == 1 and cells[1][2] == 1 and cells[#cells][1] == 10 and #cells == 13)
    end
    g:setBlocked(5, 6, true)
    assert(g:findPath(1, 1, 10, 1) == nil)
    assert(not pcall(g.findPath, g, 1, 1, 11, 1))
    assert(not pcall(g.setBlocked, g, 0, 1, true))
    g:destroy()
    assert(not pcall(g.getSize, g))

    local s = nav.newSurface{ boxes = { { position = { 0, -0.5, 0 }, size = { 20, 1, 20 } },
        { position = { 0, 1, 2 }, size = { 1, 2, 16 } } }, cellSize = 0.2 }
    local f = nav.newFlow(s, { 8, 0, 0 })
    for z = -8, 8, 4 do
        local _, length = f:findPath{ -8, 0, z }
        local _, exact = s:findPath({ -8, 0, z }, { 8, 0, 0 })
        assert(math.abs(length - exact) < 1e-4, length .. " " .. exact)
    end
    local a = nav.newAgent{ position = { -8, 0, 0 } }
    a:follow(f)
    assert(a:getState() == "walking" and a:getLink() == nil)
    f:destroy()
    local graph = nav.newGraph()
    graph:connect(graph:add(0, 0, 0), graph:add(3, 0, 0))
    function corsac.draw()
        s:draw(true)
        graph:draw(true)
        nav.drawAgents()
    end
    assert(not pcall(s.draw, s)) -- not while the simulation runs
end
