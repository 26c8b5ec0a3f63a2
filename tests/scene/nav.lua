-- args: --steps 900
-- A graph built by hand, searched, changed; agents that walk it: one alone, one that leads an entity,
-- one that pushes a body; a door that closes on the way.
local nav, scene = corsac.nav, corsac.scene
local graph, path, walker, guide, pusher, cart, crate

local function expectError(part, f, ...)
  local ok, message = pcall(f, ...)
  if ok or not tostring(message):find(part, 1, true) then
    error("expected an error with '" .. part .. "', got: " .. tostring(message))
  end
end

function corsac.load()
  graph = nav.newGraph{ name = "yard", maxLinks = 8 }
  for z = 0, 4 do
    for x = 0, 4 do
      assert(graph:add(2 * x, 0, 2 * z) == x + 5 * z)
    end
  end
  for z = 0, 4 do
    for x = 0, 4 do
      local id = x + 5 * z
      if x < 4 then graph:connect(id, id + 1) end
      if z < 4 then graph:connect(id, id + 5) end
    end
  end
  assert(graph:getCount() == 25 and #graph:getNodes() == 25)
  assert(graph:nearest(3.2, 1, 0.1) == 2 and graph:nearest(100, 0, 0, 5) == nil)
  local x, y, z = graph:getPosition(7)
  assert(x == 4 and y == 0 and z == 2)
  local links = graph:getLinks(12)
  assert(#links == 4 and links[1].to == 7 and links[1].cost == 2 and links[1].open)

  local ids, cost, status = graph:findPath(0, 24)
  assert(#ids == 9 and ids[1] == 0 and ids[9] == 24 and cost == 16 and status == "found")
  assert(select(2, graph:findPath(0, 24, { heuristic = "zero" })) == 16)
  assert(select(2, graph:findPath(0, 24, { heuristic = "octile", weight = 2 })) <= 32)
  local island = graph:add(50, 0, 0)
  local none, nothing, why = graph:findPath(0, island)
  assert(none == nil and nothing == 0 and why == "no path")
  ids, cost, status = graph:findPath(0, island, { partial = true })
  assert(status == "partial" and ids[#ids] == 4 and cost == 8)
  assert(select(3, graph:findPath(0, 24, { limit = 2 })) == "limit")
  graph:link(island, 0, 0.5)
  assert(select(2, graph:findPath(island, 24)) == 16.5)
  graph:remove(island)
  assert(graph:getText():find("node 0 (0, 0, 0): 1 (2) 5 (2)", 1, true))

  expectError("no node 25", graph.findPath, graph, 0, island)
  expectError("itself", graph.connect, graph, 3, 3)
  expectError("weight", graph.findPath, graph, 0, 1, { wieght = 2 })
  expectError("an entity or a mover", nav.newAgent, {})

  path = nav.newPath(graph, { 0, 0, 0 }, { 8, 0, 0 })
  assert(path:getStatus() == "found" and path:getCost() == 8 and #path:getNodes() == 5)

  walker = nav.newAgent{ position = { 0, 0, 0 }, maxSpeed = 3, turnRate = 5 }
  walker:go(graph, 8, 0, 8)
  cart = scene.spawn{ position = { 0, 1, 8 } }
  guide = nav.newAgent{ entity = cart, offset = 1, maxSpeed = 2 }
  guide:go(graph, 8, 0, 0)
  corsac.phys.setGravity(0, 0, 0)
  crate = scene.spawn{ position = { 8, 0.5, 8 }, body = { shape = "box", size = { 0.5, 0.5, 0.5 } } }
  pusher = nav.newAgent{ entity = crate, offset = 0.5 }
  pusher:go(graph, 0, 0, 0)
  assert(walker:getState() == "walking" and guide:getEntity() == cart and walker:getEntity() == nil)
end

function corsac.fixed()
  if corsac.getStep() == 30 then
    graph:setOpen(1, 2, false)
    graph:disconnect(0, 5)
  elseif corsac.getStep() == 31 then
    assert(path:getStatus() == "found")
    corsac.metrics.set("detour", path:getCost())
  end
end

function corsac.event() end

local function off(object, x, y, z)
  local px, py, pz = object:getPosition()
  return math.sqrt((px - x) ^ 2 + (py - y) ^ 2 + (pz - z) ^ 2)
end

function corsac.update()
  corsac.metrics.set("walker", off(walker, 8, 0, 8))
  corsac.metrics.set("cart", off(cart, 8, 1, 0))
  corsac.metrics.set("crate", off(crate, 0, 0.5, 0))
  local arrived = 0
  for _, agent in ipairs{ walker, guide, pusher } do
    arrived = arrived + (agent:getState() == "arrived" and 1 or 0)
  end
  corsac.metrics.set("arrived", arrived)
end

corsac.expect("user.detour", "==", 12)
corsac.expect("user.walker", "<=", 0.1)
corsac.expect("user.cart", "<=", 0.1)
corsac.expect("user.crate", "<=", 0.15)
corsac.expect("user.arrived", "==", 3)
corsac.expect("counts.nav_nodes", "==", 25)
corsac.expect("counts.agents", "==", 3)
corsac.expect("counts.paths", "==", 4)
