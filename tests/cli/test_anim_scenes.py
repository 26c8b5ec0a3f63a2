"""The scenes of scripts/scenes/anim state what must come of them; each also gives one hash on two threads."""

import unittest

from support import ROOT, corsac

STEPS = {"crowd": 120, "ragdoll": 420}


class AnimScenes(unittest.TestCase):
    def test_every_scene_keeps_its_expectations_on_one_hash(self):
        scenes = sorted((ROOT / "scripts/scenes/anim").glob("*.lua"))
        self.assertGreaterEqual(len(scenes), 5)
        for scene in scenes:
            with self.subTest(scene=scene.stem):
                hashes = set()
                for threads in (1, 2):
                    done = corsac("run", scene, "--headless", "--quiet", "--hash", "--threads", threads,
                                  "--steps", STEPS.get(scene.stem, 300))
                    self.assertEqual(done.code, 0, str(done))
                    hashes.add(done.out)
                self.assertEqual(len(hashes), 1)


if __name__ == "__main__":
    unittest.main()
