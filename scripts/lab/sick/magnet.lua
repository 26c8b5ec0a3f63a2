-- sick: stiffness
-- A magnet so strong that a nail flies off instead of hanging on.
function corsac.load()
    corsac.phys.setGravity(0, 0, 0)
    corsac.phys.newField{ type = "point", strength = 1000, core = 0.05 }
    corsac.scene.spawn{
        position = { 0.04, 0, 0 }, mesh = "sphere", name = "nail",
        body = { shape = "sphere", radius = 0.01 },
    }
end
