"""Pictures: golden images, shots at steps, video, the same frame with a window and without.

A golden image may differ in 0.1 % of its pixels by more than 5 of 255. After a wanted change:
GOLDEN=write python3 -m unittest test_picture, and look at the new picture.
"""

import os
import shutil
import unittest
from pathlib import Path

import png
from support import ROOT, SceneCase, figure

GOLDEN = Path(__file__).resolve().parents[1] / "golden"

ROOM = """
local gfx = corsac.gfx
function corsac.load()
  gfx.setBackground(0.02, 0.03, 0.05)
  gfx.setAmbient(0.05, 0.05, 0.06)
  gfx.setCamera{ position = { 0, 3, 9 }, target = { 0, 1, 0 } }
  gfx.newLight{ type = "directional", direction = { -0.5, -1, -0.3 }, color = { 1, 0.95, 0.9 }, intensity = 2 }
  gfx.newLight{ type = "point", position = { 3, 3, 3 }, color = { 0.2, 0.5, 1 }, intensity = 20, radius = 12 }
  corsac.scene.spawn{ position = { 0, -0.5, 0 }, mesh = "box", color = { 0.6, 0.6, 0.65 },
    body = { type = "static", shape = "box", size = { 12, 1, 12 } } }
  for i = 1, 5 do
    corsac.scene.spawn{ position = { 1.3 * (i - 3), 2 + 0.4 * i, 0 }, mesh = i % 2 == 0 and "box" or "sphere",
      color = { i / 5, 0.4, 1 - i / 5 },
      body = i % 2 == 0 and { shape = "box", size = { 0.9, 0.9, 0.9 } } or { shape = "sphere", radius = 0.5 } }
  end
end
"""


class Picture(SceneCase):
    def golden(self, name, text, *args):
        out, kept = self.dir / f"{name}.png", GOLDEN / f"{name}.png"
        self.assert_exit(self.run_scene(text, "--size", "192x108", "--shot", out, "--quiet", *args), 0)
        if os.environ.get("GOLDEN") == "write":
            shutil.copy(out, kept)
        share = png.compare(kept, out)
        if not figure(f"gfx: golden picture {name}, pixels off by more than 5 of 255", share, 0.001, "of all"):
            sheet = ROOT / f"out/golden-{name}.png"
            sheet.parent.mkdir(exist_ok=True)
            png.difference(kept, out, sheet)
            self.fail(f"{100 * share:.2f} % of the pixels differ; expected, actual, difference: {sheet.name} in out/")

    def test_room_as_it_starts(self):
        self.golden("room-1", ROOM, "--steps", 1)

    def test_room_when_all_has_fallen(self):
        self.golden("room-180", ROOM, "--steps", 180)

    def test_shots_at_steps_and_a_video(self):
        first, last = self.dir / "new/first.png", self.dir / "last.png"
        done = self.run_scene(ROOM, "--size", "64x36", "--steps", 12, "--shot", f"{first}@3", "--shot", last,
                              "--video", self.dir / "video", "--quiet")
        self.assert_exit(done, 0)
        frames = sorted((self.dir / "video").iterdir())
        self.assertEqual([f.name for f in frames], [f"frame-{i:06}.png" for i in range(1, 13)])
        self.assertEqual(png.compare(first, frames[2], 0), 0)
        self.assertEqual(png.compare(last, frames[11], 0), 0)
        self.assertGreater(png.compare(first, last), 0)

    def test_a_run_that_ends_early_has_its_last_picture(self):
        ended, plain = self.dir / "ended.png", self.dir / "plain.png"
        leaves = ROOM + "function corsac.fixed() if corsac.getStep() == 29 then corsac.exit(0) end end"
        fails = ROOM + "function corsac.fixed() if corsac.getStep() == 29 then boom() end end"
        args = ("--size", "64x36", "--quiet", "--shot")
        self.assert_exit(self.run_scene(ROOM, *args, plain, "--steps", 30), 0)
        for text, code in ((leaves, 0), (fails, 1)):
            self.assert_exit(self.run_scene(text, *args, ended, "--steps", 100), code)
            self.assertEqual(png.compare(plain, ended, 0), 0)
            ended.unlink()

    def test_a_window_shows_the_same_picture(self):
        a, b = self.dir / "a.png", self.dir / "b.png"
        args = ("--size", "128x72", "--steps", 40, "--quiet", "--shot")
        self.assert_exit(self.run_scene(ROOM, *args, f"{b}@40", window=True), 0)
        self.assert_exit(self.run_scene(ROOM, *args, a), 0)
        self.assertEqual(png.compare(a, b, 2), 0)


if __name__ == "__main__":
    unittest.main()
