"""Scenes that several command line tests run."""

EMPTY = "-- nothing\n"

BALLS = """
local n = corsac.param("n", 20)
function corsac.load()
  corsac.scene.spawn{ name = "floor", position = { 0, -0.5, 0 }, mesh = "box",
    body = { type = "static", shape = "box", size = { 40, 1, 40 } } }
  for i = 1, n do
    corsac.scene.spawn{ name = "ball" .. i, mesh = "sphere",
      position = { 0.3 * math.random(), 1.2 * i, 0.3 * math.random() },
      body = { shape = "sphere", radius = 0.5 } }
  end
end
"""

STAGES = ("script scene phys phys.fields phys.broad phys.narrow phys.islands phys.solve phys.ccd anim nav "
          "audio metrics gfx.cull gfx.cluster gfx.draw gfx.gpu").split()
COUNTS = ("bodies awake shapes pairs contacts joints islands islands_coarse islands_fine substeps_max triggers lights clusters light_refs draws "
          "triangles skeletons bones nav_nodes agents paths voices entities lua_kb").split()
ACCURACY = ("penetration_max_m penetration_mean_m energy_j energy_drift momentum_drift joint_error_max_m "
            "tunnelled nan anim_error_max_m path_ratio_max").split()
MEMORY = "peak_rss_kb core phys gfx anim nav audio script".split()
