"""What the report built with -Ofast must hold here: one hash for -O1 and -O2, and values that are no
longer finite are still seen (with -ffast-math a compiler may remove that check)."""

import unittest

from support import ROOT, SceneCase, corsac

O1 = ROOT / "build/gcc-asan/corsac"  # MODE=asan compiles with -O1


class Flags(SceneCase):
    def test_o1_and_o2_give_one_hash(self):
        if not O1.exists():
            self.skipTest("build/gcc-asan/corsac is absent (make MODE=asan all)")
        for scene, args in (("spheres", ("--set", "n=300")), ("boxes", ("--set", "n=8"))):
            words = ("run", ROOT / f"scripts/scenes/{scene}.lua", "--headless", "--quiet", "--hash", "--steps", 120, *args)
            fast, slow = corsac(*words), corsac(*words, program=O1, env={"ASAN_OPTIONS": "detect_leaks=0"})
            self.assert_exit(fast, 0)
            self.assert_exit(slow, 0)
            self.assertEqual(fast.out, slow.out)

    def test_what_is_not_finite_is_refused_and_named(self):
        for value in ("0 / 0", "1 / 0", "-1 / 0"):
            done = self.run_scene("""
                local ball
                function corsac.load() ball = corsac.scene.spawn{ body = { shape = "sphere", radius = 0.5 } } end
                function corsac.fixed() ball:getBody():setVelocity(%s, 0, 0) end""" % value, "--steps", 3)
            self.assert_exit(done, 1, "scene.lua:4", "argument 1 (x): expected a number")


if __name__ == "__main__":
    unittest.main()
