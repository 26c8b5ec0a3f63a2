-- args: --steps 1500
-- A surface from the boxes of a level: a ramp of steps to a platform, a wall with a door, pillars;
-- twenty agents cross it among each other, one leads an entity up the steps.
local nav, scene = corsac.nav, corsac.scene
local level = {
  { position = { 0, -0.5, 0 }, size = { 30, 1, 20 } },
  { position = { 0, 1.5, -6.5 }, size = { 0.4, 3, 7 } },
  { position = { 0, 1.5, 6.5 }, size = { 0.4, 3, 7 } },
  { position = { -6, 1, 3 }, size = { 1, 2, 1 } },
  { position = { 6, 1, -3 }, size = { 1, 2, 1 } },
  { position = { 13, 0.9, 8 }, size = { 4, 1.8, 4 } },
}
for i = 1, 5 do
  level[#level + 1] = { position = { 8 + 0.6 * i, 0.15 * i, 8 }, size = { 0.6, 0.3 * i, 4 } }
end
local surface, agents, climber, stairs
local worst = 0

function corsac.load()
  surface = nav.newSurface{ boxes = level, cellSize = 0.2 }
  assert(surface:getPolygonCount() > 5 and surface:getArea() > 400)
  local points, length = surface:findPath({ -10, 0, -8 }, { 10, 0, -8 })
  assert(#points == 4 and length > 22.5 and length < 23.5, "through the door, by two of its corners")
  local x, y, z = surface:nearest(0, 0, 5)
  assert(math.abs(x) > 0.4 and y == 0 and z > 0, "beside the wall")
  assert(surface:nearest(100, 0, 0, 5) == nil)
  assert(select(2, surface:findPath({ -10, 0, 0 }, { 13, 1.8, 8 })) > 23, "up the steps")
  local path = surface:newPath({ -10, 0, -8 }, { 10, 0, -8 })
  assert(#path:getPoints() == 4 and math.abs(path:getCost() - length) < 1e-6)
  path:destroy()
  assert(not pcall(nav.newSurface, { vertices = { 0, 0, 0 }, triangles = { 1, 1, 2 } }))

  agents = {}
  for i = 1, 20 do
    local side = i % 2 == 0 and 1 or -1
    local agent = nav.newAgent{ position = { -8 * side, 0, 0.8 * i - 8 } }
    agent:cross(surface, 8 * side, 0, 0.8 * i - 8)
    agents[i] = agent
  end
  stairs = scene.spawn{ position = { 2, 0.9, 8 } }
  climber = nav.newAgent{ entity = stairs, offset = 0.9 }
  climber:cross(surface, 13, 1.8, 8)
end

function corsac.update()
  local arrived, overlap = 0, 0
  for i, agent in ipairs(agents) do
    arrived = arrived + (agent:getState() == "arrived" and 1 or 0)
    local x, _, z = agent:getPosition()
    for k = 1, i - 1 do
      local ox, _, oz = agents[k]:getPosition()
      overlap = math.max(overlap, 0.6 - math.sqrt((x - ox) ^ 2 + (z - oz) ^ 2))
    end
  end
  corsac.metrics.set("arrived", arrived)
  worst = math.max(worst, overlap)
  corsac.metrics.set("overlap", worst)
  local x, y, z = stairs:getPosition()
  corsac.metrics.set("climb", math.sqrt((x - 13) ^ 2 + (y - 2.7) ^ 2 + (z - 8) ^ 2))
end

corsac.expect("user.arrived", "==", 20)
corsac.expect("user.overlap", "<=", 0.006)
corsac.expect("user.climb", "<=", 0.15)
corsac.expect("counts.agents", "==", 21)
