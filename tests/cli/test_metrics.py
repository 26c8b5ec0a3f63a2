"""The metrics JSON: every key of the contract, its type, and what it says of known scenes."""

import csv
import json
import re
import unittest

from scenes import ACCURACY, BALLS, COUNTS, EMPTY, MEMORY, STAGES
from support import CORSAC, SceneCase, corsac

NUMBER = (int, float)


class Metrics(SceneCase):
    def metrics(self, text, *args):
        done = self.run_scene(text, "--metrics", "-", *args)
        self.assert_exit(done, 0)
        return json.loads(done.out)

    def test_every_key_and_type(self):
        m = self.metrics(BALLS, "--steps", 60, "--seed", 7, "--threads", 2, "--simd", "sse2")
        self.assertEqual(m["corsac"], corsac("--version").out.split()[1])
        self.assertTrue(m["scene"].endswith("scene.lua"))
        self.assertEqual((m["seed"], m["threads"], m["simd"], m["steps"]), (7, 2, "sse2", 60))
        self.assertEqual(m["dt"], 1 / 60)
        self.assertRegex(m["hash"], re.compile("^[0-9a-f]{16}$"))
        self.assertGreater(m["wall_s"], 0)
        self.assertAlmostEqual(m["realtime_factor"], 1.0 / m["wall_s"], delta=0.01 / m["wall_s"])
        self.assertEqual(list(m["step_ms"]), ["mean", "p50", "p95", "p99", "max"])
        self.assertEqual(list(m["stages"]), STAGES)
        for stage in STAGES:
            self.assertEqual(list(m["stages"][stage]), ["p50", "p95", "max", "total"])
            for value in m["stages"][stage].values():
                self.assertIsInstance(value, (*NUMBER, type(None)))
        self.assertEqual(list(m["counts"]), COUNTS)
        self.assertEqual(list(m["memory"]), MEMORY)
        peaks = [f"{name}_peak" for name in ACCURACY if name != "energy_j"]
        self.assertEqual(sorted(m["accuracy"]), sorted(ACCURACY + peaks))
        self.assertIsInstance(m["steady_allocations"], int)
        for key in ("warnings", "asserts"):
            self.assertEqual(m[key], [])
        self.assertEqual(m["user"], {})

    def test_figures_of_a_known_scene(self):
        m = self.metrics(BALLS, "--steps", 300, "--set", "n=5")
        self.assertEqual(m["counts"]["bodies"], 6)
        self.assertEqual(m["counts"]["shapes"], 6)
        self.assertEqual(m["counts"]["entities"], 6)
        self.assertEqual(m["accuracy"]["nan"], 0)
        self.assertEqual(m["accuracy"]["tunnelled"], 0)
        self.assertLess(m["accuracy"]["penetration_max_m"], 0.02)
        self.assertGreaterEqual(m["accuracy"]["penetration_max_m_peak"], m["accuracy"]["penetration_max_m"])
        self.assertGreater(m["stages"]["phys"]["total"], 0)
        self.assertGreater(m["memory"]["phys"], 0)
        self.assertEqual(m["steady_allocations"], 0)

    def test_an_empty_scene_pays_nothing(self):
        m = self.metrics(EMPTY, "--steps", 200)
        for room in ("phys", "gfx"):
            self.assertEqual(m["memory"][room], 0, room)
        for stage, figures in m["stages"].items():
            if stage not in ("script", "scene"):
                self.assertIn(figures["total"], (0, None), stage)
        for count in COUNTS:
            if count != "lua_kb":
                self.assertIn(m["counts"][count], (0, None), count)
        if "-asan" not in CORSAC:  # the sanitizer's own memory is not the engine's
            self.assertLessEqual(m["memory"]["peak_rss_kb"], 25 * 1024)
        self.assertEqual(m["steady_allocations"], 0)
        self.assertIsNone(m["device"])

    def test_user_figures_and_warnings(self):
        m = self.metrics("""
            function corsac.load() corsac.metrics.set("score", 2.5); corsac.warn("low on cheese") end
            function corsac.fixed() corsac.metrics.set("score", 3.5) end""", "--steps", 2)
        self.assertEqual(m["user"], {"score": 3.5})
        self.assertEqual(len(m["warnings"]), 1)
        self.assertIn("low on cheese", m["warnings"][0])

    def test_a_body_that_starts_in_a_wall_is_seen_by_the_accuracy_kernel(self):
        m = self.metrics("""
            function corsac.load()
              corsac.phys.setGravity(0, 0, 0)
              for i = 0, 1 do
                corsac.scene.spawn{ position = { 0.75 * i, 0, 0 }, body = { shape = "sphere", radius = 0.5 } }
              end
            end""", "--steps", 1, "--set", "metrics.accuracy=on")
        self.assertGreater(m["accuracy"]["penetration_max_m"], 0.1)
        self.assertLess(m["accuracy"]["penetration_max_m"], 0.2501)

    def test_accuracy_can_be_switched_off(self):
        m = self.metrics(BALLS, "--steps", 60, "--set", "metrics.accuracy=off")
        self.assertEqual(m["stages"]["metrics"]["total"], 0)

    def test_a_file_equals_stdout_but_for_times(self):
        path = self.dir / "deep/er/metrics.json"
        done = self.run_scene(BALLS, "--steps", 20, "--metrics", path)
        self.assert_exit(done, 0)
        a, b = json.loads(path.read_text()), self.metrics(BALLS, "--steps", 20)
        for key in ("hash", "seed", "steps", "accuracy", "user"):
            self.assertEqual(a[key], b[key])
        self.assertEqual({**a["counts"], "lua_kb": 0}, {**b["counts"], "lua_kb": 0})

    def test_csv_has_a_line_a_step(self):
        path = self.dir / "steps.csv"
        self.assert_exit(self.run_scene(BALLS, "--steps", 60, "--metrics-csv", path, "--quiet"), 0)
        rows = list(csv.DictReader(path.read_text().splitlines()))
        self.assertEqual([int(row["step"]) for row in rows], list(range(1, 61)))
        self.assertEqual(rows[-1]["bodies"], "21")
        self.assertEqual(rows[-1]["skeletons"] in ("", "0"), True)
        self.assertGreater(float(rows[-1]["phys_ms"]), 0)

    def test_trace_is_chrome_json(self):
        path = self.dir / "trace.json"
        self.assert_exit(self.run_scene(BALLS, "--steps", 10, "--trace", path, "--quiet"), 0)
        trace = json.loads(path.read_text())
        events = trace["traceEvents"] if isinstance(trace, dict) else trace
        names = [event["name"] for event in events]
        self.assertEqual(names.count("phys"), 10)

    def test_receipt_shows_zeros_for_the_unused(self):
        done = self.run_scene(EMPTY, "--steps", 10, "--receipt")
        self.assert_exit(done, 0)
        for room in ("phys", "gfx"):
            self.assertRegex(done.out, re.compile(rf"^ +{room} +0 +0\.00 +0\.00", re.M))
        for room in ("anim", "nav", "audio"):
            self.assertRegex(done.out, re.compile(rf"^ +{room} +(0 +0\.00 +0\.00|not built)", re.M))
        self.assertIn("passes 0, shader variants 0", done.out)
        used = self.run_scene(BALLS, "--steps", 10, "--receipt", "--set", "n=3")
        self.assertRegex(used.out, re.compile(r"^ +phys +[1-9][0-9]+ ", re.M))
        self.assertIn("bodies 4", used.out)
        drawn = self.run_scene(BALLS, "--steps", 2, "--receipt", "--shot", self.dir / "a.png", "--size", "64x64")
        self.assertRegex(drawn.out, r"frames 1, passes [1-9]\d*, shader variants [1-9]")


if __name__ == "__main__":
    unittest.main()
