"""scripts/game: a bot plays it from title to end, is caught, falls; recorded, modded, on other threads."""

import json
import sys
import tempfile
import unittest
from pathlib import Path

import png
import wav
from support import CORSAC, ROOT, corsac, run

GAME = "scripts/game"
STAGES = ("script scene phys phys.fields phys.broad phys.narrow phys.islands phys.solve phys.ccd anim nav audio metrics "
          "gfx.cull gfx.cluster gfx.draw").split()


def play(plan, *args, limit=60):
    return corsac("run", GAME, "--headless", "--set", f"bot={plan}", "--quiet", *args, limit=limit)


def mean(path, box):
    """Mean red, green, blue of a part of a picture: left, top, right, bottom in shares of its size."""
    width, height, channels, rows = png.read(path)
    left, top, right, bottom = (round(share * size) for share, size in zip(box, (width, height) * 2))
    places = [(x, y) for y in range(top, bottom) for x in range(left, right)]
    return [sum(rows[y][x * channels + k] for x, y in places) / len(places) for k in range(3)]


class Played(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.dir = Path(folder.name)
        cls.done = play("play", "--size", "320x180", "--threads", 1, "--metrics", "-", "--record", cls.dir / "game.crr",
                        "--shot", cls.dir / "title.png@50", "--shot", cls.dir / "paused.png@150", "--shot", cls.dir / "end.png",
                        "--audio", cls.dir / "game.wav")
        cls.metrics = json.loads(cls.done.out) if cls.done.code == 0 else None

    def setUp(self):
        self.assertEqual(self.done.code, 0, str(self.done))

    def test_from_title_to_end_in_under_a_minute(self):
        user = self.metrics["user"]
        for name in ("finished", "key", "door", "passed", "crossed"):
            self.assertEqual(user[name], 1, name)
        self.assertGreaterEqual(user["escaped"], 1)
        self.assertEqual((user["caught"], user["fallen"]), (0, 0))
        self.assertGreaterEqual(user["lanterns"], 10)
        self.assertLess(self.metrics["wall_s"], 60)

    def test_every_stage_worked_and_nothing_was_allocated(self):
        for stage in STAGES:
            self.assertGreater(self.metrics["stages"][stage]["total"], 0, stage)
        self.assertEqual(self.metrics["steady_allocations"], 0)
        self.assertEqual(self.metrics["warnings"], [])
        self.assertEqual((self.metrics["accuracy"]["nan"], self.metrics["accuracy"]["tunnelled"]), (0, 0))
        counts = self.metrics["counts"]
        self.assertGreaterEqual(counts["lights"], 200)
        self.assertEqual((counts["skeletons"], counts["agents"]), (2, 1))

    def test_one_hash_on_any_threads_and_instructions(self):
        for args in (("--threads", 2), ("--threads", 1, "--simd", "sse2")):
            done = play("play", "--hash", *args)
            self.assertEqual(done.out.strip(), self.metrics["hash"], str(done))

    def test_the_recording_plays_again(self):
        done = corsac("run", GAME, "--headless", "--replay", self.dir / "game.crr", "--quiet", "--hash")
        self.assertEqual((done.code, done.out.strip()), (0, self.metrics["hash"]), str(done))

    def test_the_pictures_are_of_a_night_that_ends_lit(self):
        title, end = mean(self.dir / "title.png", (0, 0, 1, 1)), mean(self.dir / "end.png", (0.3, 0.3, 0.7, 0.9))
        self.assertGreater(title[2], title[0])  # moonlight is blue
        self.assertTrue(15 < sum(title) / 3 < 70, title)
        self.assertGreater(end[0], end[2] + 10)  # the great lantern is not
        paused, under = mean(self.dir / "paused.png", (0, 0, 1, 1)), mean(self.dir / "title.png", (0, 0, 1, 1))
        self.assertLess(sum(paused), sum(under))
        for name in ("title", "paused", "end"):
            width, _, channels, rows = png.read(self.dir / f"{name}.png")
            if channels == 4:  # what is laid over the frame leaves the picture opaque
                self.assertEqual({row[4 * x + 3] for row in rows for x in range(width)}, {255}, name)

    def test_it_is_heard(self):
        rate, left, right = wav.read(self.dir / "game.wav")
        self.assertLess(wav.level(left, 0, rate // 10), wav.level(left, 20 * rate, 30 * rate))  # music fades in
        for begin in range(5, int(len(left) / rate) - 1, 5):
            self.assertGreater(wav.level(left, begin * rate, (begin + 1) * rate), 0.01)
        self.assertLess(max(map(abs, left[::3])), 1.0)
        self.assertLess(max(map(abs, right[::3])), 1.0)


class Mishaps(unittest.TestCase):
    def expect(self, plan, **wanted):
        done = play(plan, "--metrics", "-")
        self.assertEqual(done.code, 0, str(done))
        user = json.loads(done.out)["user"]
        self.assertEqual({name: user[name] for name in wanted}, wanted)

    def test_the_hound_catches_once_and_lets_go(self):
        self.expect("caught", caught=1, fallen=0, finished=0)

    def test_a_fall_into_the_water_leads_back_to_the_bank(self):
        self.expect("fall", caught=0, fallen=1, finished=0)

    def test_enter_at_the_end_begins_anew(self):
        self.expect("again", again=1, finished=0, playing=0, lanterns=0)

    def test_an_unknown_plan_names_those_there_are(self):
        done = play("chase")
        self.assertEqual(done.code, 1)
        self.assertIn("the plans are play, caught, fall and again, not chase", done.err)


class Modded(unittest.TestCase):
    def test_a_mod_doubles_the_fireflies_and_the_bot_still_finishes(self):
        figures = []
        for mod in ((), ("--mod", "scripts/mods/midsummer")):
            done = play("play", "--metrics", "-", *mod)
            self.assertEqual(done.code, 0, str(done))
            figures.append(json.loads(done.out))
        plain, modded = figures
        self.assertEqual(modded["user"]["finished"], 1)
        self.assertNotEqual(plain["hash"], modded["hash"])
        lamps = [m["counts"]["lights"] - m["user"]["lanterns"] for m in figures]  # those that were woken are apart
        self.assertEqual(lamps[1] - lamps[0], 220)


class Window(unittest.TestCase):
    def test_enter_begins_and_w_walks_north(self):
        helper = ROOT / "tests/cli/xkeys.py"
        keys = "wait:2 key:Return wait:1 down:w wait:2 up:w wait:0.5 key:p wait:0.5 key:BackSpace"
        done = run([sys.executable, str(helper), keys, CORSAC, "run", GAME, "--size", "160x90", "--render", "none",
                    "--metrics", "-"], True, cwd=ROOT, timeout=90)
        if done.returncode == 77:
            self.skipTest("libXtst.so.6 is not installed")
        self.assertEqual(done.returncode, 0, done.stderr)
        user = json.loads(done.stdout)["user"]
        self.assertLess(user["z"], 21.5)  # it began at 22.5
        self.assertEqual(user["playing"], 0)


if __name__ == "__main__":
    unittest.main()
