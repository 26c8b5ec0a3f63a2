"""A window: keys and pointer of a real X display, overlay, pause, single step, error screen, reload."""

import sys
import unittest
from pathlib import Path

import png
from support import CORSAC, ROOT, SceneCase, run

SCENE = """
local heard = {}
function corsac.conf(t) t.actions = { go = "d" } end
function corsac.load()
  corsac.scene.spawn{ position = { 0, 0, 0 }, mesh = "box" }
end
function corsac.event(name, a, b, c)
  corsac.log("heard " .. name .. " " .. tostring(a) .. " " .. tostring(b))
end
local held, was = 0, 0
function corsac.fixed()
  if corsac.input.isDown("go") then held = held + 1 end
  corsac.metrics.set("held", held)
end
"""


class Window(SceneCase):
    def press(self, keys, text, *args):
        scene = self.write("scene.lua", text)
        helper = Path(__file__).with_name("xkeys.py")
        command = [sys.executable, helper, f"wait:1 move:100,60 {keys}", CORSAC, "run", scene,
                   "--size", "320x200", *args]
        done = run([str(word) for word in command], True, cwd=ROOT, timeout=90)
        if done.returncode == 77:
            self.skipTest("libXtst.so.6 is not installed")
        return done.returncode, done.stdout, done.stderr

    def test_keys_reach_the_script_and_escape_ends_the_run(self):
        code, out, err = self.press("down:d wait:0.5 up:d click:1 wait:0.2 key:Escape", SCENE, "--metrics", "-")
        self.assertEqual(code, 0, err)
        for text in ("heard key d 1", "heard key d 0", "heard text d nil", "heard mouse mouse1 1", "heard move 100 60"):
            self.assertIn(text, err.replace(".0", ""))
        held = float(out.split('"held":')[1].split("\n")[0].rstrip(","))
        self.assertTrue(2 <= held <= 600, held)

    def test_escape_belongs_to_a_game_that_binds_it(self):
        bound = SCENE.replace('go = "d"', 'go = "d", menu = "escape"')
        code, _, err = self.press("key:Escape wait:0.3", bound, "--steps", 240)
        self.assertEqual(code, 0, err)
        self.assertIn("heard key escape 1", err)

    def test_overlay(self):
        shots = []
        for keys in ("wait:0.1", "key:F1"):
            path = self.dir / f"{len(shots)}.png"
            self.assertEqual(self.press(keys, SCENE, "--steps", 200, "--shot", f"{path}@200")[0], 0)
            shots.append(path)
        self.assertGreater(png.compare(*shots), 0.02)

    def test_overlay_pages(self):
        """Stages, settings that change the picture, a console that runs Lua; a fourth F1 leaves nothing."""
        def shot(keys, *args, steps=170):
            path = self.dir / "page.png"
            code, _, err = self.press(keys, SCENE, "--steps", steps, "--shot", path, *args)
            self.assertEqual(code, 0, err)
            return png.read(path), err
        stages, settings = shot("key:F1")[0], shot("key:F1 key:F1 key:Right")[0]
        self.assertNotEqual(stages, settings)
        self.assertEqual(shot("key:F1 key:F1 key:F1 key:F1")[0], shot("wait:0.1")[0])
        console, err = shot("key:F1 key:F1 key:F1 key:7 key:minus key:2 key:Return wait:0.4", steps=240)
        self.assertNotEqual(console, settings)
        self.assertRegex(err, r"> 7-2\n(.*\n)?5\n")
        self.assertNotIn("heard text 7", err)
        _, err = shot("key:F1 key:F1 key:F1 key:7 key:Return wait:0.4", "--record", self.dir / "run.rec", steps=240)
        self.assertIn("the console is closed while a run is recorded", err)

    def test_overlay_draws_the_state_machine(self):
        text = """
            function corsac.load()
              local bones = corsac.anim.newSkeleton{ { name = "root" } }
              local clip = corsac.anim.newClip{ skeleton = bones, duration = 1, keys = { { bone = "root", time = 0 } } }
              corsac.anim.newAnimator(bones, corsac.anim.newMachine{
                states = { { name = "idle", clip = clip }, { name = "walk", clip = clip } },
                transitions = { { from = "idle", to = "walk", event = "go" } } })
            end"""
        shots = []
        for keys in ("wait:0.1", "key:F1 key:F1 key:Down key:Right key:F1 key:F1"):
            path = self.dir / f"machine{len(shots)}.png"
            code, _, err = self.press(keys, text, "--size", "900x500", "--steps", 240, "--shot", f"{path}@240")
            self.assertEqual(code, 0, err)
            shots.append(path)
        self.assertGreater(png.compare(*shots), 0.1)  # its panel is a quarter of the picture

    def test_pause_and_single_step(self):
        # Paused somewhere after step 20; two single steps later there are two steps more, and no others.
        code, _, err = self.press("saw:step=20. key:F4 wait:0.8 key:F3 wait:0.3 key:F3 wait:0.3 key:Escape",
                                  "function corsac.fixed() corsac.log('step=' .. corsac.getStep() .. '.') end")
        self.assertEqual(code, 0, err)
        self.assertTrue(20 < err.count("step=") < 100, err.count("step="))

    def test_f2_shows_the_ghost_of_the_reference_world(self):
        text = """
            function corsac.load()
              corsac.log("loaded")
              corsac.scene.spawn{ position = { 0, -0.5, 0 }, mesh = "box", color = { 0.4, 0.4, 0.4 },
                body = { type = "static", shape = "box", size = { 9, 1, 9 } } }
              for i = 1, 12 do
                corsac.scene.spawn{ position = { 0.1 * (i % 3), 1.1 * i, 0 }, mesh = "sphere",
                  color = { 0.9, 0.8, 0.7 }, body = { shape = "sphere", radius = 0.5, restitution = 0.5 } }
              end
            end"""
        shots = []
        for keys in ("wait:0.1", "key:F2 wait:0.1"):
            path = self.dir / f"ghost{len(shots)}.png"
            code, _, err = self.press(keys, text, "--steps", 240, "--shot", f"{path}@240")
            self.assertEqual(code, 0, err)
            shots.append(path)
        self.assertEqual(err.count("loaded"), 3, err)  # at the start, again for F2, and the ghost's own
        self.assertGreater(png.compare(*shots), 0.02)
        code, _, err = self.press("saw:loaded key:F2 saw:loaded*3 wait:0.2 key:F2 wait:0.2 key:F2 saw:loaded*5 "
                                  "wait:0.2 key:Escape", text)
        self.assertEqual((code, err.count("loaded")), (0, 5), err)

    def test_an_error_shows_and_f5_loads_again(self):
        text = """
            function corsac.load() corsac.log("loaded") end
            function corsac.fixed() if corsac.getStep() == 20 then boom() end end"""
        code, _, err = self.press("saw:corsac.fixed*1 wait:0.2 key:F5 saw:corsac.fixed*2 key:Escape", text)
        self.assertEqual(code, 1)
        self.assertEqual(err.count("loaded"), 2, err)
        self.assertEqual(err.count("scene.lua:3"), 4, err)  # said and traced, twice


if __name__ == "__main__":
    unittest.main()
