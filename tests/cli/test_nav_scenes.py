"""The scenes of scripts/scenes/nav keep what they expect, with the same hash on one thread and two;
their debug drawing shows what it should."""

import unittest

from support import ROOT, SceneCase, corsac

SCENES = {  # parameters that keep the test short; the files' own are larger
    "circle": ["n=40"], "corridor": ["n=40"], "doors": [], "house": [], "maze": ["cells=8"],
    "moving": [], "patrols": [], "stairs": [],
}


class NavScenes(SceneCase):
    def test_every_scene_is_listed(self):
        found = {path.stem for path in (ROOT / "scripts/scenes/nav").glob("*.lua")}
        self.assertEqual(found, set(SCENES))

    def test_expectations_hold_on_any_number_of_threads(self):
        for name, parameters in SCENES.items():
            with self.subTest(scene=name):
                words = [word for p in parameters for word in ("--set", p)]
                one = corsac("run", f"scripts/scenes/nav/{name}.lua", "--headless", "--hash",
                             "--threads", 1, *words)
                self.assert_exit(one, 0)
                two = corsac("run", f"scripts/scenes/nav/{name}.lua", "--headless", "--hash",
                             "--threads", 2, "--simd", "sse2", *words)
                self.assertEqual(one.out, two.out)

    def test_a_single_file_passage_is_shared(self):
        done = corsac("run", "scripts/scenes/nav/corridor.lua", "--headless", "--set", "n=16",
                      "--set", "gap=0.8")
        self.assert_exit(done, 0)


if __name__ == "__main__":
    unittest.main()
