"""Record and replay: the same run again, where it diverges, and recordings from strangers."""

import struct
import unittest

from scenes import BALLS
from support import SceneCase, corsac

PUSHED = BALLS + """
function corsac.fixed()
  if corsac.getStep() == 36 then
    corsac.scene.find("ball3"):getBody():setVelocity(0, 0, 1)
  end
end
"""


class Replay(SceneCase):
    def setUp(self):
        super().setUp()
        self.file = self.dir / "run.crr"

    def record(self, text, *args):
        done = self.run_scene(text, "--record", self.file, "--hash", "--quiet", *args)
        self.assert_exit(done, 0)
        return done.out

    def replay(self, text, *args, **options):
        return self.run_scene(text, "--replay", self.file, "--hash", "--quiet", *args, **options)

    def test_it_runs_again_with_its_seed_settings_and_arguments(self):
        text = """
            function corsac.load(args)
              corsac.scene.spawn{ position = { tonumber(args[1]), 3, corsac.param("z", 0) },
                body = { shape = "sphere", radius = 0.5 } }
              corsac.metrics.set("drawn", math.random())
            end"""
        was = self.record(text, "--steps", 50, "--seed", 99, "--dt", 0.01, "--set", "z=4", "--set",
                          "phys.substeps=2", "--", 7)
        for threads in (1, 2):
            done = self.replay(text, "--threads", threads)
            self.assert_exit(done, 0)
            self.assertEqual(done.out, was)
        # The first 20 steps of a recording are a run too.
        self.assert_exit(self.replay(text, "--steps", 20), 0)

    def test_saved_data_is_part_of_the_recording(self):
        text = """
            local step, early = 0, corsac.save.read("slot")
            function corsac.load()
              assert(early.height == 3)
              local saved = corsac.save.read("slot") or { height = 1 }
              ball = corsac.phys.newBody{ shape = "sphere", position = { 0, saved.height, 0 } }
              assert(corsac.save.read("none") == nil)
            end
            function corsac.fixed()
              step = step + 1
              if step == 5 then
                corsac.save.write("slot", { height = 7 })
                ball:setPosition(0, 7, 0)
              end
            end"""
        player = {"CORSAC_SAVE": str(self.dir / "player")}
        self.write("player/slot.json", '{"version": 1, "data": {"height": 3}}')
        done = self.run_scene(text, "--steps", 10, "--record", self.file, "--hash", "--quiet", env=player)
        self.assert_exit(done, 0)
        self.assertIn("7", (self.dir / "player/slot.json").read_text())
        # The player has gone on since: the replay sees what the run saw, and leaves the files alone.
        self.write("player/slot.json", '{"version": 1, "data": {"height": 11}}')
        again = self.replay(text, env=player)
        self.assert_exit(again, 0)
        self.assertEqual(again.out, done.out)
        self.assertIn("11", (self.dir / "player/slot.json").read_text())
        data = self.file.read_bytes()
        at = data.index(b"READ")
        for offset in (4, 8, 12, 18, 22, 26):
            self.file.write_bytes(data[:at + offset] + b"\xff\xff\xff\x7f" + data[at + offset + 4:])
            self.assertIn(self.replay(text, env=player).code, (1, 2, 4), offset)

    def test_in_a_window(self):
        was = self.record(BALLS, "--steps", 30)
        done = self.replay(BALLS, "--size", "64x64", window=True)
        self.assert_exit(done, 0)
        self.assertEqual(done.out, was)

    def test_divergence_names_step_object_and_column(self):
        self.record(BALLS, "--steps", 60, "--set", "n=5")
        done = self.replay(PUSHED)
        self.assert_exit(done, 4, "'scene.lua' is not the file that was recorded")
        self.assertRegex(done.err, r"replay diverged at step 37: phys\.bodies row \d+ "
                                   r"\(entity 'ball3', handle \d+:\d+\), column [pqvw][xyz]")

    def test_another_number_of_bodies(self):
        self.record(BALLS, "--steps", 10)
        done = self.replay(BALLS.replace('corsac.param("n", 20)', "21"))
        self.assert_exit(done, 4, "replay diverged at step 1: scene.entities has 22 rows, the recording 21")

    def test_a_changed_hash_is_found(self):
        self.record(BALLS, "--steps", 10, "--set", "n=2")
        data = bytearray(self.file.read_bytes())
        at = data.rindex(b"phys.bodies") + len(b"phys.bodies") + 8
        data[at] ^= 1
        self.file.write_bytes(data)
        self.assert_exit(self.replay(BALLS), 4, "replay diverged at step 10: phys.bodies (no single row), column")

    def test_damaged_recordings_are_refused_whole(self):
        self.record(BALLS, "--steps", 5, "--set", "n=3")
        data = self.file.read_bytes()
        for size in (0, 3, 4, 30, len(data) // 2, len(data) - 1):
            self.file.write_bytes(data[:size])
            self.assert_exit(self.replay(BALLS), 2, "run.crr'")
        self.file.write_bytes(data + b"x")
        self.assert_exit(self.replay(BALLS), 2, "is cut or damaged")
        self.file.write_bytes(b"PK" + data[2:])
        self.assert_exit(self.replay(BALLS), 2, "is no recording of corsac")

    def test_every_length_field_is_distrusted(self):
        self.record(BALLS, "--steps", 2, "--set", "n=3")
        data = self.file.read_bytes()
        for at in range(4, min(len(data) - 4, 600), 11):
            for value in (0xffffffff, 0x7fffffff, 0x10000):
                self.file.write_bytes(data[:at] + struct.pack("<I", value) + data[at + 4:])
                done = self.replay(BALLS, "--steps", 2)
                self.assertIn(done.code, (0, 1, 2, 4), f"at {at}: {done}")

    def test_it_opens_no_path_of_the_file(self):
        self.record(BALLS, "--steps", 3)
        data = self.file.read_bytes()
        self.assertIn(b"scene.lua", data)
        other = data.replace(b"scene.lua", b"nowhere.x")
        self.file.write_bytes(other)
        self.assert_exit(self.replay(BALLS), 0)

    def test_mods_are_known_by_what_is_in_them(self):
        mod = self.dir / "mods/cheese"
        self.write("mods/cheese/mod.lua", 'return { name = "cheese", version = "1" }')
        self.write("mods/cheese/main.lua", "-- version one")
        self.record(BALLS, "--steps", 3, "--mod", mod)
        done = self.replay(BALLS, "--mod", mod)
        self.assert_exit(done, 0)
        self.assertNotIn("warning", done.err)
        self.assertIn("'mod cheese/main.lua' is not the file that was recorded, or missing", self.replay(BALLS).err)
        self.write("mods/cheese/main.lua", "-- version two")
        self.assertIn("'mod cheese/main.lua' is not the file that was recorded", self.replay(BALLS, "--mod", mod).err)
        self.assertNotIn(str(mod).encode(), self.file.read_bytes())

    def test_options_that_contradict_the_recording(self):
        self.record(BALLS, "--steps", 3)
        scene = self.write("scene.lua", BALLS)
        for args in (("--seed", 1), ("--dt", 0.1), ("--set", "n=2"), ("--substeps", 2)):
            self.assert_exit(corsac("run", scene, "--headless", "--replay", self.file, *args), 2, "--replay takes")
        self.assert_exit(corsac("run", scene, "--replay", self.file, "--record", self.file), 2, "exclude each other")
        self.assert_exit(corsac("run", scene, "--headless", "--replay", self.dir / "none.crr"), 2, "none.crr")


if __name__ == "__main__":
    unittest.main()
