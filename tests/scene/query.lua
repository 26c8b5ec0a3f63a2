-- args: --steps 5
-- Tags and queries: by tag, component, box and ball.
local scene = corsac.scene

local function names(options)
  local list = {}
  for i, entity in ipairs(scene.findAll(options)) do
    list[i] = entity:getName()
  end
  table.sort(list)
  return table.concat(list, " ")
end

local function expect(options, wanted)
  local found = names(options)
  if found ~= wanted then
    error("expected '" .. wanted .. "', found '" .. found .. "'", 2)
  end
end

function corsac.load()
  corsac.phys.setGravity(0, 0, 0)
  scene.spawn{ name = "wolf", tags = { "enemy", "beast" }, position = { 5, 0, 0 },
    body = { shape = "sphere", radius = 0.5 } }
  scene.spawn{ name = "robber", tags = { "enemy" }, position = { -5, 0, 0 }, mesh = "box" }
  scene.spawn{ name = "deer", tags = { "beast" }, position = { 0, 0, 8 }, mesh = "sphere",
    body = { shape = "sphere", radius = 0.5 } }
  scene.spawn{ name = "stone", position = { 0, 0, 1 } }
end

function corsac.fixed()
  if corsac.getStep() == 1 then
    expect({}, "deer robber stone wolf")
    expect({ tags = { "enemy" } }, "robber wolf")
    expect({ tags = { "enemy", "beast" } }, "wolf")
    expect({ tags = { "beast" }, without = { "enemy" } }, "deer")
    expect({ tags = { "nobody" } }, "")
    expect({ has = { "body" } }, "deer wolf")
    expect({ has = { "body", "mesh" } }, "deer")
    expect({ center = { 0, 0, 0 }, radius = 5 }, "robber stone wolf")
    expect({ center = { 5, 0, 1 }, radius = 2, has = { "body" } }, "wolf")
    expect({ min = { -1, -1, -1 }, max = { 1, 1, 10 } }, "deer stone")
    expect({ min = { 0, 0, 2 } }, "deer")
  elseif corsac.getStep() == 2 then
    local wolf = scene.find("wolf")
    assert(wolf:hasTag("enemy") and not wolf:hasTag("tame"))
    wolf:removeTag("enemy")
    wolf:addTag("tame")
    expect({ tags = { "enemy" } }, "robber")
    expect({ tags = { "tame" } }, "wolf")
    scene.find("robber"):destroy()
    expect({ tags = { "enemy" } }, "")
    local ok, message = pcall(scene.findAll, { has = { "wings" } })
    assert(not ok and message:find("wings", 1, true), message)
    ok, message = pcall(scene.findAll, { tags = { 3 } })
    assert(not ok and message:find("names in an array", 1, true), message)
    corsac.metrics.set("done", 1)
  end
end

corsac.expect("user.done", "==", 1)
