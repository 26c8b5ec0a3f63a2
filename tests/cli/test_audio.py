"""--audio: what the scene says can be measured in the file."""

import json
import unittest

import wav
from scenes import BALLS, EMPTY
from support import SceneCase

PASSING = """
local source
function corsac.load()
  corsac.audio.setListener{ position = { 0, 0, 0 } }
  source = corsac.audio.newSource{ sound = corsac.audio.newSound("sounds/hum.wav"), loop = true,
    position = { -4, 0, -1 } }
end
function corsac.fixed()
  source:setPosition(-4 + 8 * corsac.getStep() / 120, 0, -1)
end
"""


class Audio(SceneCase):
    def capture(self, text, *args):
        path = self.dir / "sound.wav"
        done = self.run_scene(text, "--audio", path, "--quiet", "--hash", *args)
        self.assert_exit(done, 0)
        return wav.read(path), path.read_bytes(), done.out

    def test_a_sound_moves_from_left_to_right(self):
        (rate, left, right), _, _ = self.capture(PASSING, "--steps", 120)
        self.assertEqual((rate, len(left), len(right)), (48000, 96000, 96000))
        self.assertGreater(wav.louder(left, right, 4800, 24000), 10)
        self.assertGreater(wav.louder(right, left, 72000, 91200), 10)
        middle = wav.louder(left, right, 47200, 48800)
        self.assertLess(abs(middle), 1.5)

    def test_two_captures_are_the_same_bytes_and_change_nothing_else(self):
        _, first, hash_first = self.capture(PASSING, "--steps", 60)
        _, second, _ = self.capture(PASSING, "--steps", 60, "--threads", 2, "--simd", "sse2")
        self.assertEqual(first, second)
        self.assertEqual(hash_first, self.run_scene(PASSING, "--steps", 60, "--hash", "--quiet").out)

    def test_the_file_is_as_long_as_the_run(self):
        (_, left, _), _, _ = self.capture(PASSING, "--steps", 7, "--dt", 0.01003)
        self.assertEqual(len(left), round(7 * 0.01003 * 48000))

    def test_a_scene_without_sound_is_silent_and_pays_nothing(self):
        (_, left, right), _, _ = self.capture(EMPTY, "--steps", 30)
        self.assertEqual((max(map(abs, left)), max(map(abs, right))), (0, 0))
        m = json.loads(self.run_scene(BALLS, "--steps", 5, "--metrics", "-").out)
        self.assertEqual((m["memory"]["audio"], m["counts"]["voices"], m["stages"]["audio"]["total"]), (0, 0, 0))

    def test_voices_and_stage_in_the_metrics_of_a_run_without_a_device(self):
        m = json.loads(self.run_scene(PASSING, "--steps", 90, "--metrics", "-").out)
        self.assertEqual((m["counts"]["voices"], m["steady_allocations"], m["warnings"]), (1, 0, []))
        self.assertGreater(m["stages"]["audio"]["total"], 0)

    def test_without_a_sound_card_a_window_warns_once(self):
        done = self.run_scene(PASSING, "--steps", 20, "--metrics", "-", "--size", "64x64", window=True,
                              env={"ALSOFT_DRIVERS": "none"})
        self.assert_exit(done, 0)
        warnings = [text for text in json.loads(done.out)["warnings"] if "silent" in text]
        self.assertEqual(len(warnings), 1, warnings)

    def test_a_source_follows_its_entity_and_ends_with_it(self):
        text = """
            local e, s
            function corsac.load()
              corsac.audio.setListener{ position = { 0, 0, 0 } }
              e = corsac.scene.spawn{ position = { 3, 0, 0 } }
              s = corsac.audio.newSource{ sound = corsac.audio.newSound("sounds/hum.wav"), loop = true, entity = e }
            end
            function corsac.fixed()
              if corsac.getStep() == 20 then e:setPosition(-3, 0, 0) end
              if corsac.getStep() == 40 then e:destroy() end
            end
            corsac.expect("counts.voices", "==", 0)"""
        (_, left, right), _, _ = self.capture(text, "--steps", 60)
        self.assertGreater(wav.louder(right, left, 1600, 15000), 20)
        self.assertGreater(wav.louder(left, right, 18000, 31000), 20)
        self.assertLess(max(map(abs, left[36000:])), 1e-6)

    def test_a_wall_muffles_what_is_behind_it(self):
        text = """
            function corsac.conf(t) t.audio = { occlusion = "on" } end
            local wall
            function corsac.load()
              corsac.audio.setListener{ position = { 0, 0, 0 } }
              local radio = corsac.scene.spawn{ position = { 0, 0, -4 },
                body = { type = "static", shape = "box", size = { 1, 1, 1 } } }
              corsac.audio.newSource{ sound = corsac.audio.newSound("sounds/hum.wav"), loop = true, entity = radio }
            end
            function corsac.fixed()
              if corsac.getStep() == 60 then
                wall = corsac.scene.spawn{ position = { 0, 0, -2 },
                  body = { type = "static", shape = "box", size = { 4, 4, 0.2 } } }
              elseif corsac.getStep() == 180 then
                wall:destroy()
              end
            end"""
        (_, left, _), _, _ = self.capture(text, "--steps", 300)
        free, behind, again = (left[s * 800:(s + 1) * 800 + 24000] for s in (20, 120, 240))
        # The hum breathes once a second: the same second of it is compared.
        muffled = wav.louder(behind, free, 0, 24000)
        self.assertTrue(-30 < muffled < -9, muffled)
        self.assertLess(abs(wav.louder(again, free, 0, 24000)), 2)
        (_, open_left, _), _, _ = self.capture(text, "--steps", 300, "--set", "audio.occlusion=off")
        self.assertLess(abs(wav.louder(open_left[120 * 800:], open_left[0 * 800:], 0, 24000)), 2)

    def test_settings_and_errors(self):
        self.assert_exit(self.run_scene(PASSING, "--set", "audio.voice=3"), 2, "did you mean voices")
        self.assert_exit(self.run_scene(PASSING.replace("hum.wav", "hmu.wav")), 1, "hum.wav")
        self.assert_exit(self.run_scene(PASSING.replace("loop = true", "looop = true")), 1, "loop")
        (_, left, _), _, _ = self.capture(PASSING, "--steps", 10, "--set", "audio.volume=0")
        self.assertEqual(max(map(abs, left)), 0)


if __name__ == "__main__":
    unittest.main()
