-- A maze of walls made of bodies; the surface is found from the physics world, agents walk from one
-- corner to the other, and the grid's shortest way (in steps of cells) is set against the surface's.
local cells = corsac.param("cells", 12)
local n = corsac.param("n", 6)
local show = corsac.param("show", false)
local nav, scene, gfx = corsac.nav, corsac.scene, corsac.gfx
local size, half = 3, 1.5 * cells
local surface, agents = nil, {}

local function carve() -- depth first, without recursion: open[i] holds the walls that were removed
    local open, seen, stack = {}, { [1] = true }, { 1 }
    while #stack > 0 do
        local at = stack[#stack]
        local x, z, around = (at - 1) % cells, math.floor((at - 1) / cells), {}
        for _, d in ipairs{ { 1, 0 }, { -1, 0 }, { 0, 1 }, { 0, -1 } } do
            local nx, nz = x + d[1], z + d[2]
            local other = nz * cells + nx + 1
            if nx >= 0 and nz >= 0 and nx < cells and nz < cells and not seen[other] then
                around[#around + 1] = other
            end
        end
        if #around == 0 then
            stack[#stack] = nil
        else
            local other = around[math.random(#around)]
            seen[other], stack[#stack + 1] = true, other
            open[math.min(at, other) .. " " .. math.max(at, other)] = true
        end
    end
    return open
end

local function wall(x, z, wide, deep)
    scene.spawn{
        position = { x, 1, z }, mesh = "box", color = { 0.5, 0.46, 0.4 },
        body = { type = "static", shape = "box", size = { wide, 2, deep } },
    }
end

local function middle(cell)
    return size * ((cell - 1) % cells) + 1.5 - half, size * math.floor((cell - 1) / cells) + 1.5 - half
end

function corsac.conf(t) t.steps = math.floor(cells * cells * 60 * size / 1.5 / 2 + 1200) end

function corsac.load()
    scene.spawn{
        position = { 0, -0.5, 0 }, mesh = "box", color = { 0.3, 0.34, 0.3 },
        body = { type = "static", shape = "box", size = { 2 * half + 1, 1, 2 * half + 1 } },
    }
    local open = carve()
    local grid = nav.newGrid(2 * cells - 1, 2 * cells - 1) -- odd cells are rooms, even ones walls
    for cell = 1, cells * cells do
        local x, z = middle(cell)
        local column, row = 2 * ((cell - 1) % cells) + 1, 2 * math.floor((cell - 1) / cells) + 1
        local east, north = open[cell .. " " .. cell + 1], open[cell .. " " .. cell + cells]
        if column < 2 * cells - 1 then
            grid:setBlocked(column + 1, row, not east)
            if not east then wall(x + 1.5, z, 0.3, size + 0.3) end
            if row < 2 * cells - 1 then grid:setBlocked(column + 1, row + 1, true) end
        end
        if row < 2 * cells - 1 then
            grid:setBlocked(column, row + 1, not north)
            if not north then wall(x, z + 1.5, size + 0.3, 0.3) end
        end
    end
    for side = -1, 1, 2 do
        wall(side * half, 0, 0.3, 2 * half)
        wall(0, side * half, 2 * half, 0.3)
    end
    surface = nav.newSurface{ from = "physics", cellSize = 0.15 }
    local ax, az = middle(1)
    local bx, bz = middle(cells * cells)
    local points, length = surface:findPath({ ax, 0, az }, { bx, 0, bz })
    local _, steps = grid:findPath(1, 1, 2 * cells - 1, 2 * cells - 1)
    corsac.metrics.set("corners", #points)
    corsac.metrics.set("ratio", length / (steps * size / 2)) -- corners are cut, the cells' are not
    for i = 1, n do
        local body = scene.spawn{
            position = { ax + 0.7 * ((i - 1) % 2), 0.9, az + 0.7 * math.floor((i - 1) / 2) - 0.7 },
            scale = { 0.6, 0.9, 0.6 }, mesh = "capsule", color = { 0.9, 0.3 + 0.6 * i / n, 0.2 },
        }
        agents[i] = nav.newAgent{ entity = body, offset = 0.9, turnRate = 8, arrive = 1.2 }
        agents[i]:cross(surface, bx, 0, bz)
    end
    gfx.setCamera{ position = { 0, 2.2 * half, 1.2 * half }, target = { 0, 0, 0 } }
end

function corsac.fixed()
    local arrived = 0
    for _, agent in ipairs(agents) do
        arrived = arrived + (agent:getState() == "arrived" and 1 or 0)
    end
    corsac.metrics.set("arrived", arrived)
end

function corsac.draw()
    if show then
        surface:draw()
        nav.drawAgents()
    end
end

corsac.expect("user.arrived", "==", n)
corsac.expect("user.ratio", "<=", 1.0)
corsac.expect("user.ratio", ">=", 0.6)
corsac.expect("accuracy.path_ratio_max", "<=", 1.1)
