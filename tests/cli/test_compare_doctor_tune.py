"""compare, doctor and tune on scenes whose answers are known."""

import json
import re
import unittest

import png
from support import ROOT, SceneCase, corsac

BOXES, SPHERES = ROOT / "scripts/scenes/boxes.lua", ROOT / "scripts/scenes/spheres.lua"
SICK = sorted((ROOT / "scripts/lab/sick").glob("*.lua"))

HEALTHY = """
function corsac.load()
  corsac.scene.spawn{ position = { 0, -0.5, 0 }, body = { type = "static", shape = "box", size = { 40, 1, 40 } } }
  for i = 1, 8 do
    corsac.scene.spawn{ position = { 0, i - 0.5, 0 },
      body = { shape = "box", size = { 1, 1, 1 }, density = i == 8 and 10000 or 1000 } }
  end
  corsac.scene.spawn{ position = { 5, 9, 0 }, body = { shape = "box", size = { 1, 0.5, 0.2 },
    angularVelocity = { 1, 15, 1 } } }
  corsac.scene.spawn{ position = { -8, 3, 0 }, body = { shape = "sphere", radius = 0.5, velocity = { 0, 0, 30 } } }
end
"""


class Compare(SceneCase):
    def compare(self, scene, *words):
        done = corsac("compare", scene, "--size", "160x90", "--shot", self.dir / "ghost.png", "--metrics", "-", *words)
        self.assert_exit(done, 0)
        return json.loads(done.out)

    def test_threads_change_nothing(self):
        c = self.compare(SPHERES, "--steps", 60, "--set", "n=200", "--a", "threads=1", "--b", "threads=2")
        self.assertEqual((c["error_max_mm"], c["first_divergence_s"]), (0, None))
        self.assertEqual(c["entities"], 209)

    def test_solvers_differ_by_millimetres(self):
        c = self.compare(BOXES, "--steps", 120, "--set", "n=6", "--a", "phys.solver=soft", "--b", "phys.solver=sequential")
        self.assertGreater(c["error_max_mm"], 0.01)
        self.assertLess(c["error_max_mm"], 100)
        self.assertGreaterEqual(c["error_max_mm"], c["error_mean_mm"])
        self.assertGreaterEqual(c["error_peak_mm"], c["error_max_mm"])
        self.assertRegex(c["first_divergence_object"], r"^entity \d+:\d+")
        for side in ("a", "b"):
            self.assertGreater(c[side]["ms_per_step"], 0)

    def test_a_known_distance(self):
        scene = self.write("scene.lua", """
            function corsac.load()
              corsac.phys.setGravity(0, 0, 0)
              corsac.scene.spawn{ name = "ball", mesh = "sphere",
                body = { shape = "sphere", radius = 0.5, velocity = { corsac.param("speed", 1), 0, 0 } } }
              corsac.gfx.setCamera{ position = { 0, 0, 9 }, target = { 0, 0, 0 } }
              corsac.gfx.setAmbient(1, 1, 1)
            end""")
        c = self.compare(scene, "--steps", 60, "--a", "speed=1", "--b", "speed=1.5")
        self.assertAlmostEqual(c["error_max_mm"], 500, delta=0.1)
        self.assertAlmostEqual(c["first_divergence_s"], 1 / 60, delta=1e-6)
        self.assertIn("'ball'", c["first_divergence_object"])
        c = self.compare(scene, "--steps", 60, "--a", "dt=0.0166666667", "--b", "dt=0.0083333333")
        self.assertLess(c["error_max_mm"], 0.1)
        self.assertEqual((c["a"]["steps"], c["b"]["steps"]), (60, 120))

    def test_the_picture_shows_a_and_the_ghost(self):
        args = (SPHERES, "--steps", 40, "--set", "n=60", "--a", "seed=1", "--b")
        self.compare(*args, "seed=1")
        same = (self.dir / "ghost.png").rename(self.dir / "same.png")
        self.compare(*args, "seed=2")
        self.assertGreater(png.compare(same, self.dir / "ghost.png"), 0.01)

    def test_usage(self):
        self.assert_exit(corsac("compare", BOXES), 2, "NAME=VALUE")
        self.assert_exit(corsac("compare", BOXES, "--a", "phys.solvr=soft", "--shot", self.dir / "x.png"), 2, "solver")
        self.assert_exit(corsac("compare", self.dir / "none.lua", "--a", "n=1"), 2, "none.lua")


class Doctor(SceneCase):
    def test_quiet_on_healthy_scenes(self):
        for scene, args in ((BOXES, ()), (SPHERES, ("--set", "n=500")), (ROOT / "scripts/scenes/hello.lua", ()),
                            (self.write("healthy.lua", HEALTHY), ())):
            done = corsac("doctor", scene, "--steps", 240, *args)
            self.assert_exit(done, 0, "0 findings")

    def test_loud_on_sick_ones(self):
        self.assertGreaterEqual(len(SICK), 5)
        for scene in SICK:
            regime = re.match(r"-- sick: (.*)", scene.read_text()).group(1)
            done = corsac("doctor", scene, "--steps", 120)
            self.assert_exit(done, 3, f"{regime}: ", "mend: ", "entity ")

    def test_it_names_the_object(self):
        done = corsac("doctor", ROOT / "scripts/lab/sick/mass.lua", "--steps", 60)
        self.assert_exit(done, 3, "'safe'", "'crate'")

    def test_the_setting_it_names_mends(self):
        for name, steps in (("hasty", 120), ("spin", 60), ("magnet", 60)):
            scene = ROOT / f"scripts/lab/sick/{name}.lua"
            done = corsac("doctor", scene, "--steps", steps)
            mend = re.search(r"mend: (--.*)", done.out).group(1).split()
            self.assert_exit(corsac("doctor", scene, "--steps", steps, *mend), 0, "0 findings")

    def test_usage(self):
        self.assert_exit(corsac("doctor"), 2)
        self.assert_exit(corsac("doctor", self.dir / "none.lua"), 2, "none.lua")


class Tune(SceneCase):
    def tune(self, *args):
        return corsac("tune", *args, "--out", self.dir / "settings.json")

    def test_the_settings_keep_the_bound_and_cheaper_ones_do_not(self):
        args = (ROOT / "scripts/lab/stack.lua", "--steps", 180)
        done = self.tune(*args, "--error", "user.sag_mm<=2", "--error", "accuracy.nan==0")
        self.assert_exit(done, 0, "HOLD", "out ")
        found = json.loads((self.dir / "settings.json").read_text())
        self.assertLessEqual(found["error"]["user.sag_mm"], 2)
        self.assertGreater(found["cost_ms_per_step"], 0)
        words = found["run"].split()
        again = corsac("run", *args, "--headless", "--quiet", "--seed", 9, "--metrics", "-", *words)
        self.assertLessEqual(json.loads(again.out)["user"]["sag_mm"], 2)

    def test_a_looser_bound_is_met_earlier_on_the_front(self):
        tried = []
        for bound in ("user.sag_mm<=50", "user.sag_mm<=0.8"):
            done = self.tune(ROOT / "scripts/lab/stack.lua", "--steps", 180, "--error", bound)
            self.assert_exit(done, 0, "HOLD")
            tried.append(done.out.split("HOLD")[0].count("out "))
        self.assertLess(*tried)

    def test_it_refuses_what_nothing_keeps(self):
        done = self.tune(BOXES, "--steps", 30, "--set", "n=3", "--error", "accuracy.penetration_max_m<=0")
        self.assert_exit(done, 3, "no setting")
        self.assertFalse((self.dir / "settings.json").exists())

    def test_usage(self):
        self.assert_exit(self.tune(BOXES, "--steps", 5, "--error", "accuracy.penetration_max<=1"), 2, "penetration_max_m")
        self.assert_exit(self.tune(BOXES, "--error", "nonsense"), 2, "METRIC<=VALUE")


if __name__ == "__main__":
    unittest.main()
