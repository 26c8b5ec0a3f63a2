"""The scenes of scripts/scenes/phys: each states its outcome by corsac.expect; they must hold."""

import unittest

from support import ROOT, SceneCase, corsac

SCENES = sorted((ROOT / "scripts/scenes/phys").glob("*.lua"))


class PhysScenes(SceneCase):
    def test_every_scene_keeps_its_word(self):
        self.assertGreaterEqual(len(SCENES), 10)
        for scene in SCENES:
            with self.subTest(scene=scene.name):
                self.assert_exit(corsac("run", scene, "--headless", "--quiet"), 0)

    def test_one_hash_for_threads_and_instruction_sets(self):
        scene = ROOT / "scripts/scenes/phys/hulls.lua"
        runs = [("--threads", "1"), ("--threads", "2"), ("--simd", "sse2"), ("--simd", "avx2")]
        args = ("run", scene, "--headless", "--quiet", "--hash", "--set", "n=60", "--steps", "120", "--keep-going")
        hashes = {corsac(*args, *run).out.strip() for run in runs}
        self.assertEqual(len(hashes), 1, hashes)
        self.assertRegex(hashes.pop(), r"^[0-9a-f]{16}$")

    def test_one_hash_of_cloth_and_movers(self):
        for name in ("ropes", "mover"):
            args = ("run", ROOT / f"scripts/scenes/phys/{name}.lua", "--headless", "--quiet", "--hash",
                    "--steps", "150", "--keep-going")
            runs = [("--threads", "1"), ("--threads", "2"), ("--simd", "sse2"), ("--simd", "avx2")]
            hashes = {corsac(*args, *run).out.strip() for run in runs}
            self.assertEqual(len(hashes), 1, (name, hashes))


if __name__ == "__main__":
    unittest.main()
