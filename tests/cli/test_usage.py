"""Command line errors and their texts, stdout's purity, exit codes, new, info."""

import json
import os
import re
import signal
import subprocess
import time
import unittest
from pathlib import Path

from scenes import BALLS, EMPTY
from support import CORSAC, ROOT, SceneCase, corsac


class Usage(SceneCase):
    def fails(self, *args, code=2):
        done = corsac(*args)
        self.assert_exit(done, code)
        self.assertEqual(done.out, "")
        return done.err

    def test_no_command_and_unknown_command(self):
        self.assertIn("corsac run SCENE.lua|DIR", self.fails())
        self.assertIn("no command 'rnu', did you mean 'run'?", self.fails("rnu"))
        self.assertIn("`corsac help` lists all", self.fails("elephant"))

    def test_help_goes_to_stdout(self):
        done = corsac("run", "--help")
        self.assert_exit(done, 0, "--headless", "--metrics FILE.json|-", "--shot FILE.png[:PASS][@STEP]")
        self.assertEqual(done.err, "")
        self.assert_exit(corsac("help"), 0, "corsac new DIR")

    def test_option_errors_name_the_nearest(self):
        scene = self.write("scene.lua", EMPTY)
        for args, text in (
                (("--stepz", 5), "no option '--stepz', did you mean '--steps'?"),
                (("--elephant",), "no option '--elephant'; `corsac run --help` lists all"),
                (("--steps",), "--steps needs N"),
                (("--steps", "many"), "--steps is 'many', expected a whole number from 0 to"),
                (("--steps", "-3"), "--steps is '-3', expected a whole number"),
                (("--dt", 0), "--dt is '0', expected a number above 0, at most 1"),
                (("--dt", "nan"), "--dt is 'nan', expected a number"),
                (("--simd", "axv2"), "--simd is 'axv2' (did you mean 'avx2'?), expected one of auto, sse2"),
                (("--render", "defered"), "--render is 'defered', expected one of auto, forward"),
                (("--size", "640"), "--size is '640', expected WIDTHxHEIGHT, each 16 to 16384"),
                (("--size", "8x8"), "--size is '8x8', expected WIDTHxHEIGHT"),
                (("--set", "n"), "--set is 'n', expected NAME=VALUE"),
                (("--shot", "x.jpg"), "--shot is 'x.jpg', expected a file name that ends in .png"),
                (("--shot", "x.png@0"), "expected FILE.png[:PASS] or FILE.png[:PASS]@STEP with STEP from 1"),
                (("--headless=yes",), "--headless takes no value, got 'yes'"),
                (("--steps", 1, "--seconds", 1), "--steps and --seconds exclude each other"),
                (("other.lua",), "only one scene"),
                (("--threads", 65), "--threads is '65', expected a whole number from 0 to 64"),
                (("--set", "phys.solvr=soft"), "did you mean"),
                (("--set", "physics.solver=soft"), "rooms with settings are"),
                (("--set", "metrics.accuracy=maybe"), "expected on or off"),
                (("--set", "actions.jump=spcae"), "no key 'spcae', did you mean 'space'?")):
            with self.subTest(args=args):
                self.assertIn(text, self.fails("run", scene, "--headless", *args))

    def test_scenes_that_are_not_there(self):
        self.write("garden.lua", EMPTY)
        self.assertIn("which scene?", self.fails("run"))
        self.assertIn("did you mean 'garden.lua'", self.fails("run", self.dir / "graden.lua"))
        self.assertIn("has no main.lua; `corsac new DIR`", self.fails("run", self.dir))
        self.assertIn("expected a .lua file or a folder", self.fails("run", self.dir / "no/such"))

    def test_undeclared_parameters(self):
        done = self.run_scene(BALLS, "--set", "count=3")
        self.assert_exit(done, 2, "scene.lua has no parameter 'count' (--set count=3)")
        done = self.run_scene('function corsac.load() corsac.param("spheres", 1) end', "--set", "sphere=3")
        self.assert_exit(done, 2, "did you mean 'spheres'?")

    def test_unwritable_outputs_end_it_before_the_run(self):
        (self.dir / "file").write_text("")
        (self.dir / "folder").mkdir()
        scene = "function corsac.load() error('the run has begun') end"
        for option, path in (("--metrics", "file/m.json"), ("--metrics", "folder"), ("--record", "folder"),
                             ("--shot", "file/s.png"), ("--video", "file"), ("--trace", "folder"),
                             ("--metrics-csv", "folder")):
            done = self.run_scene(scene, option, self.dir / path)
            self.assert_exit(done, 2, str(self.dir / path).split("/s.png")[0])
            self.assertNotIn("the run has begun", done.err)

    def test_an_output_that_was_only_tried_is_not_left_behind(self):
        path = self.dir / "sub/m.json"
        self.assert_exit(self.run_scene(BALLS, "--set", "x=1", "--metrics", path), 2)
        self.assertFalse(path.exists())

    def test_stdout_carries_only_what_was_asked_for(self):
        scene = 'function corsac.load() print("hello"); corsac.log("there") end'
        done = self.run_scene(scene, "--steps", 5, "--metrics", "-", "--receipt")
        self.assert_exit(done, 0, "hello", "there", "receipt:")
        self.assertEqual(json.loads(done.out)["steps"], 5)
        done = self.run_scene(scene, "--steps", 5, "--hash")
        self.assertRegex(done.out, re.compile(r"\A[0-9a-f]{16}\n\Z"))
        done = self.run_scene(scene, "--steps", 5, "--quiet")
        self.assertNotIn("steps in", done.out + done.err)
        self.assertNotIn("\r", done.out + done.err)  # no progress bar in a pipe

    def test_exit_codes_of_scripts(self):
        for text, code, said in (
                ("function corsac.load() end", 0, ""),
                ("function corsac.load(", 1, "scene.lua:1"),
                ("local x = nil + 1", 1, "scene.lua:1"),
                ("function corsac.load()\n  boom()\nend", 1, "scene.lua:2"),
                ("function corsac.fixed()\n\n  boom()\nend", 1, "scene.lua:3"),
                ("corsac.expect('counts.entities', '==', 1)", 3, "counts.entities"),
                ("function corsac.load() corsac.exit(17) end", 17, ""),
                ("function corsac.fixed() corsac.expect.now('counts.bodies', '>', 0) end", 3, "counts.bodies")):
            with self.subTest(text=text):
                self.assert_exit(self.run_scene(text, "--steps", 3), code, said)

    def test_keep_going_runs_on_and_still_says_1(self):
        done = self.run_scene("function corsac.fixed() boom() end", "--steps", 4, "--keep-going", "--metrics", "-")
        self.assert_exit(done, 1)
        self.assertEqual(json.loads(done.out)["steps"], 4)
        done = self.run_scene("function corsac.fixed() boom() end", "--steps", 4, "--metrics", "-")
        self.assert_exit(done, 1)
        self.assertEqual(json.loads(done.out)["steps"], 1)

    def test_steps_from_conf_command_line_and_default(self):
        conf = "function corsac.conf(t) t.steps = 7; t.dt = 0.01; t.seed = 3 end"

        def told(*args):
            m = json.loads(self.run_scene(conf, "--metrics", "-", *args).out)
            return m["steps"], m["dt"], m["seed"]
        self.assertEqual(told(), (7, 0.01, 3))
        self.assertEqual(told("--steps", 5, "--dt", 0.02, "--seed", 0), (5, 0.02, 0))
        self.assertEqual(told("--seconds", 0.25), (25, 0.01, 3))
        m = json.loads(self.run_scene(EMPTY, "--metrics", "-").out)
        self.assertEqual((m["steps"], m["seed"]), (600, 12345))

    def test_one_scene_leads_to_another(self):
        self.write("game/main.lua", """
            function corsac.load() corsac.scene.spawn{ body = { shape = "sphere", radius = 0.5 } } end
            function corsac.fixed()
              if corsac.getStep() == 10 then corsac.run("second.lua", { score = 7, name = "fox" }) end
            end
            function corsac.quit() corsac.log("first ends") end
            corsac.expect("counts.bodies", "==", 1)""")
        self.write("game/second.lua", """
            function corsac.load()
              local data = corsac.getRunData()
              corsac.metrics.set("score", data.score)
              corsac.log(data.name .. " in second at " .. corsac.getStep())
            end
            corsac.expect("counts.bodies", "==", 0)
            corsac.expect("user.score", "==", 7)""")
        file = self.dir / "run.crr"
        done = corsac("run", self.dir / "game", "--headless", "--steps", 30, "--metrics", "-", "--record", file)
        self.assert_exit(done, 0, "first ends", "fox in second at 0")
        m = json.loads(done.out)
        self.assertEqual((m["steps"], m["counts"]["bodies"], m["counts"]["entities"]), (30, 0, 0))
        self.assert_exit(corsac("run", self.dir / "game", "--headless", "--replay", file), 0)
        self.write("game/second.lua", "corsac.expect('counts.bodies', '==', 5)")
        self.assert_exit(corsac("run", self.dir / "game", "--headless", "--steps", 30), 3, "counts.bodies")

    def test_a_folder_names_its_main_file(self):
        self.write("game/main.lua", """
            local round = (corsac.getRunData() or { round = 0 }).round
            function corsac.fixed()
              if corsac.getStep() == 3 and round == 0 then corsac.run("level", { round = 1 }) end
              if corsac.getStep() == 3 and round == 2 then corsac.metrics.set("round", round) end
            end""")
        self.write("game/level/main.lua",
                   "function corsac.fixed() if corsac.getStep() == 3 then corsac.run('.', { round = 2 }) end end")
        done = corsac("run", self.dir / "game", "--headless", "--steps", 30, "--metrics", "-")
        self.assert_exit(done, 0)
        self.assertEqual(json.loads(done.out)["user"]["round"], 2)

    def test_arguments_after_two_dashes_reach_the_script(self):
        done = self.run_scene("function corsac.load(args) print(#args, args[1], args[2]) end", "--steps", 1,
                              "--", "--steps", "two")
        self.assert_exit(done, 0)
        self.assertRegex(done.out + done.err, r"2\s+--steps\s+two")

    def test_interrupt_writes_metrics_and_gives_130(self):
        path = self.dir / "m.json"
        scene = self.write("scene.lua", BALLS)
        process = subprocess.Popen([CORSAC, "run", scene, "--headless", "--steps", "100000000", "--metrics", path],
                                   cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        time.sleep(0.7)
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=30)
        self.assertEqual(process.returncode, 130)
        steps = json.loads(path.read_text())["steps"]
        self.assertTrue(0 < steps < 100000000, steps)

    def test_environment_that_lacks_something(self):
        scene = self.write("scene.lua", EMPTY)
        env = {key: value for key, value in os.environ.items() if key not in ("DISPLAY", "WAYLAND_DISPLAY")}
        done = subprocess.run([CORSAC, "run", scene, "--steps", "1"], cwd=ROOT, env=env, capture_output=True,
                              text=True, timeout=60)
        self.assertEqual(done.returncode, 5, done.stderr)
        if "avx512f" not in Path("/proc/cpuinfo").read_text().split():
            self.assert_exit(self.run_scene(EMPTY, "--simd", "avx512"), 5, "avx512")

    def test_new_makes_a_project_that_runs(self):
        folder = self.dir / "deep/garden"
        self.assert_exit(corsac("new", folder), 0, "corsac run")
        for name in ("main.lua", "conf.lua", "README.md", ".luarc.json", "assets"):
            self.assertTrue((folder / name).exists(), name)
        json.loads((folder / ".luarc.json").read_text())
        done = corsac("run", folder, "--headless", "--steps", 120, "--set", "n=3", "--metrics", "-")
        self.assert_exit(done, 0)
        self.assertEqual(json.loads(done.out)["counts"]["bodies"], 4)
        self.assert_exit(corsac("new", folder), 2, "exists")
        self.assert_exit(corsac("new"), 2, "expected one folder")

    def test_info(self):
        done = corsac("info")
        self.assert_exit(done, 0, "corsac ", "instruction sets: sse2", "processors:", "rooms: scene script phys")
        self.assert_exit(corsac("info", "more"), 2, "takes no words")


if __name__ == "__main__":
    unittest.main()
