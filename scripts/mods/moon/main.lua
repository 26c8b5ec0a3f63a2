-- A sixth of the gravity, whatever the game asked for.
corsac.mod.after("load", function()
    local x, y, z = corsac.phys.getGravity()
    corsac.phys.setGravity(x / 6, y / 6, z / 6)
end)
