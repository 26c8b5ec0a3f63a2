"""scripts/scenes/card.lua: each thing that the scene says, asserted from metrics, picture and sound."""

import json
import shutil
import tempfile
import unittest
from pathlib import Path

import png
import wav
from support import ROOT, corsac

CARD = "scripts/scenes/card.lua"
SIZE = ("--size", "320x180")


class Card(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.dir = Path(folder.name)
        cls.done = corsac("run", CARD, "--headless", "--steps", 900, *SIZE, "--quiet", "--metrics", "-",
                          "--shot", cls.dir / "start.png@20", "--shot", cls.dir / "middle.png@375",
                          "--shot", cls.dir / "end.png", "--audio", cls.dir / "card.wav", "--threads", 1,
                          "--metrics-csv", cls.dir / "card.csv")
        cls.metrics = json.loads(cls.done.out) if cls.done.code == 0 else None

    def setUp(self):
        self.assertEqual(self.done.code, 0, str(self.done))

    def test_every_room_counts(self):
        counts = self.metrics["counts"]
        for name in "lights light_refs clusters skeletons bones nav_nodes agents paths triggers voices bodies".split():
            self.assertGreater(counts[name], 0, name)
        self.assertEqual((counts["lights"], counts["bones"], counts["nav_nodes"], counts["voices"]), (200, 24, 8, 1))
        for stage in "script scene phys anim nav audio metrics gfx.cull gfx.cluster gfx.draw".split():
            self.assertGreater(self.metrics["stages"][stage]["total"], 0, stage)
        self.assertEqual(self.metrics["steady_allocations"], 0)
        self.assertEqual(self.metrics["warnings"], [])

    def test_the_fox_walks_and_its_machine_follows(self):
        user = self.metrics["user"]
        self.assertAlmostEqual(user["fox_x"], 5.5, delta=0.15)
        self.assertEqual((user["entered"], user["left"]), (2, 2))  # idle -> walk -> idle
        self.assertLess(self.metrics["accuracy"]["anim_error_max_m_peak"], 1e-5)

    def test_the_trigger_lets_the_ball_fall(self):
        user = self.metrics["user"]
        self.assertEqual(user["opened"], 1)
        self.assertAlmostEqual(user["ball_y"], 0.6, delta=0.02)
        self.assertEqual((self.metrics["accuracy"]["nan"], self.metrics["accuracy"]["tunnelled"]), (0, 0))
        short = json.loads(corsac("run", CARD, "--headless", "--steps", 300, "--quiet", "--metrics", "-").out)
        self.assertEqual(short["user"]["opened"], 0)
        self.assertAlmostEqual(short["user"]["ball_y"], 3.075, delta=0.02)  # still on its gate

    def test_one_hash(self):
        hashes = {self.metrics["hash"]}
        for args in (("--threads", 2), ("--threads", 1, "--simd", "sse2")):
            hashes.add(corsac("run", CARD, "--headless", "--steps", 900, "--quiet", "--hash", *args).out.strip())
        self.assertEqual(len(hashes), 1, hashes)

    def test_the_sound_moves_from_left_to_right(self):
        _, left, right = wav.read(self.dir / "card.wav")
        self.assertEqual(len(left), 15 * 48000)
        self.assertGreater(wav.louder(left, right, 0, 3 * 48000), 3)
        self.assertGreater(wav.louder(right, left, 12 * 48000, 15 * 48000), 3)
        self.assertLess(abs(wav.louder(left, right, int(7.4 * 48000), int(7.6 * 48000))), 0.5)
        self.assertGreater(wav.level(left, 0, 48000), 0.003)

    def test_clustered_equals_forward(self):
        for name in ("forward", "clustered"):
            done = corsac("run", CARD, "--headless", "--steps", 375, *SIZE, "--quiet", "--set", f"render={name}",
                          "--metrics", self.dir / f"{name}.json", "--shot", self.dir / f"{name}.png")
            self.assertEqual(done.code, 0, str(done))
        self.assertEqual(png.compare(self.dir / "forward.png", self.dir / "clustered.png", 0), 0)
        # Step 375 of the toggled run is in a clustered turn.
        self.assertEqual(png.compare(self.dir / "middle.png", self.dir / "clustered.png", 0), 0)
        clusters = [json.loads((self.dir / f"{name}.json").read_text())["counts"]["clusters"]
                    for name in ("forward", "clustered")]
        self.assertEqual(clusters, [0, 16 * 9 * 24])

    def test_the_picture_is_what_the_scene_says(self):
        start, middle, end = (png.read(self.dir / f"{name}.png") for name in ("start", "middle", "end"))
        bright = sum(max(png.pixel(end, x, y)) > 60 for y in range(180) for x in range(320)) / (320 * 180)
        self.assertTrue(0.1 < bright < 0.9, bright)
        hues = {tuple(c > 90 for c in png.pixel(end, x, y)) for y in range(60, 180) for x in range(0, 320, 3)}
        self.assertGreaterEqual(len(hues), 5)  # lights of many colours on floor and walls
        # The ball, red and wide, is above its gate first and on the floor at the end.
        self.assertNotEqual(png.pixel(start, 160, 88), png.pixel(end, 160, 88))
        # The fox, orange, is left, in the middle, right.
        places = [self.orange(image) for image in (start, middle, end)]
        self.assertLess(places[0], 110)
        self.assertTrue(120 < places[1] < 200, places)
        self.assertGreater(places[2], 220)

    @staticmethod
    def orange(image):
        """Mean column of what is orange on the floor in front."""
        columns = [x for y in range(95, 150) for x in range(320)
                   for r, g, b in [png.pixel(image, x, y)] if r > 90 and 0.25 * r < g < 0.72 * r and b < 0.4 * r]
        return sum(columns) / max(len(columns), 1)

    def test_a_converted_model_is_shown(self):
        model = ROOT / "../shared/data/models/cesium_man.gltf"
        if not model.exists():
            self.skipTest("../shared/data/models/cesium_man.gltf is absent")
        scene = self.dir / "guest-scene/card.lua"
        scene.parent.mkdir(exist_ok=True)
        shutil.copy(ROOT / CARD, scene)
        done = corsac("convert", model, scene.parent / "guest")
        self.assertEqual(done.code, 0, str(done))
        name = next((scene.parent / "guest").glob("*.cmodel")).name
        done = corsac("run", scene, "--headless", "--steps", 30, *SIZE, "--quiet", "--metrics", "-", "--shot",
                      self.dir / "guest.png", "--set", f"guest=guest/{name}")
        self.assertEqual(done.code, 0, str(done))
        self.assertEqual(json.loads(done.out)["counts"]["skeletons"], 2)
        plain = self.dir / "plain.png"
        corsac("run", CARD, "--headless", "--steps", 30, *SIZE, "--quiet", "--shot", plain)
        self.assertGreater(png.compare(plain, self.dir / "guest.png"), 0.001)



if __name__ == "__main__":
    unittest.main()
