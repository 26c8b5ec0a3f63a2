-- args: --steps 60
-- A storm of entities that come and go, 102,000 in a second: what is alive at the end is what was kept,
-- and memory of the last half is not asked for again.
local kept, alive = {}, {}

function corsac.fixed()
  for _, e in ipairs(alive) do
    e:destroy()
  end
  alive = {}
  for i = 1, 1700 do
    alive[i] = corsac.scene.spawn{ position = { i, 0, 0 }, parent = i % 7 > 0 and alive[i - 1] or nil }
  end
  -- Children die with their parents: what is left to destroy are the roots.
  local roots = {}
  for i = 1, 1700 do
    if i % 7 == 0 or i == 1 then
      roots[#roots + 1] = alive[i]
    end
  end
  alive = roots
  if corsac.getStep() % 5 == 0 and corsac.getStep() < 25 then
    kept[#kept + 1] = corsac.scene.spawn{ position = { 0, 5 * #kept, 50 },
      body = { shape = "box", size = { 1, 1, 1 } } }
  end
end

corsac.expect("counts.entities", "==", 1705)
corsac.expect("counts.bodies", "==", 5)
corsac.expect("steady_allocations", "==", 0)
