"""`corsac lab` end to end: results, resumption, broken experiments, expectations, Dask workers.

Needs the lab's Python environment (`tools/setup.sh lab`); skipped where that is absent.
"""

import json
import os
import signal
import subprocess
import time
import unittest

from support import CORSAC, ROOT, SceneCase, corsac

PYTHON = ROOT / "build/venv/bin/python3"
READY = PYTHON.exists() and subprocess.run(
    [PYTHON, "-c", "import matplotlib, distributed"], capture_output=True).returncode == 0

GOOD = """
title = "Integrators"
question = "Which is better?"
kernel = "motion"
reference = "motion"
error = { key = "position_error", unit = "m" }
cost = { key = "cost_ms", unit = "ms" }
repeats = 1
[fixed]
problem = "spring"
time = 4
[methods.semi]
method = "semi"
[methods.verlet]
method = "verlet"
[sweep]
dt = [0.1, 0.05, 0.025]
[[expect]]
kind = "order"
method = "verlet"
over = "dt"
order = 2
tolerance = 0.2
"""
SCENE = """
title = "Balls"
scene = "scripts/lab/pile.lua"
error = { key = "accuracy.penetration_mean_m", unit = "m" }
seeds = [1, 2]
[fixed]
steps = 60
n = 20
[methods.soft]
"phys.solver" = "soft"
[sweep]
substeps = [1, 2, 3, 4, 5, 6]
"""
MAP = """
title = "Spring"
kernel = "motion"
reference = "motion"
[fixed]
problem = "spring"
time = 20
[methods.semi]
method = "semi"
[map]
x = { name = "dt", lo = 0.01, hi = 1, log = true }
y = { name = "k", lo = 1, hi = 1000, log = true }
grid = 3
depth = 1
[[map.criteria]]
name = "explodes"
key = "energy_ratio"
op = ">"
value = 10
"""


@unittest.skipUnless(READY, "the lab's Python packages are absent (tools/setup.sh lab)")
class Lab(SceneCase):
    def setUp(self):
        super().setUp()
        self.out = self.dir / "out"
        (self.dir / "lab").mkdir()

    def words(self, *args):
        return ["lab", "--experiments", self.dir / "lab", "--out", self.out, "--jobs", "2", *args]

    def experiment(self, name, text):
        self.write(f"lab/{name}.toml", text)

    def result(self, name, out=None):
        return json.loads(((out or self.out) / name / "result.json").read_text())

    def cases(self, name):
        lines = (self.out / name / "cases.jsonl").read_text().splitlines()
        return [json.loads(line)["id"] for line in lines]

    def test_results_charts_and_report(self):
        self.experiment("good", GOOD)
        self.experiment("map", MAP)
        done = corsac(*self.words())
        self.assert_exit(done, 0, "ok         good", "ok         map")
        found = self.result("good")
        self.assertEqual(len(found["rows"]), 6)
        for row in found["rows"]:
            self.assertGreater(row["error"]["median"], 0)
            self.assertGreater(row["cost"]["median"], 0)
        self.assertEqual(found["expectations"][0]["problems"], [])
        verdicts = {s["verdict"] for s in json.loads((self.out / "map/map.json").read_text())["methods"]["semi"]["samples"]}
        self.assertEqual(verdicts, {"stable", "explodes"})
        for name in ("good", "map"):
            self.assertIn("<svg", (self.out / f"{name}/{name}.svg").read_text())
            self.assertEqual((self.out / f"{name}/{name}.png").read_bytes()[:4], b"\x89PNG")
        page = (self.out / "report.html").read_text()
        self.assertIn("verlet costs", page)
        self.assertIn("holds", page)

    def test_an_expectation_that_fails_is_exit_3_and_a_broken_experiment_does_not_stop_the_rest(self):
        self.experiment("a_broken", GOOD.replace("[methods.semi]", "[methods.semi"))
        self.experiment("b_unknown", GOOD.replace('kernel = "motion"', 'kernel = "motino"'))
        self.experiment("c_short", GOOD.replace("order = 2", "order = 3"))
        self.experiment("d_good", GOOD)
        done = corsac(*self.words("--no-timing"))
        self.assert_exit(done, 3, "a_broken.toml", "BROKEN     b_unknown", "did you mean 'motion'", "FELL SHORT c_short",
                         "order 2.", "ok         d_good")
        self.assert_exit(corsac(*self.words("d_good", "--no-timing")), 0)
        self.assert_exit(corsac(*self.words("nothing")), 2, "no experiment 'nothing'")

    def test_an_interrupted_run_goes_on_where_it_stopped(self):
        self.experiment("scene", SCENE)
        process = subprocess.Popen([CORSAC, *map(str, self.words("--jobs", "1"))], cwd=ROOT, stdout=subprocess.DEVNULL,
                                   stderr=subprocess.DEVNULL, start_new_session=True)
        store = self.out / "scene/cases.jsonl"
        limit = time.monotonic() + 60
        while time.monotonic() < limit and not (store.exists() and len(store.read_text().splitlines()) >= 3):
            time.sleep(0.005)
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        with store.open("a") as file:
            file.write('{"id": "cut sho')  # as a killed writer leaves it
        before = self.cases_before(store)
        self.assert_exit(corsac(*self.words()), 0)
        after = self.cases_before(store)
        self.assertEqual(after[:len(before)], before)
        self.assertEqual(len(after), 12)
        self.assertEqual(len(set(after)), 12)

    @staticmethod
    def cases_before(store):
        found = []
        for line in store.read_text().splitlines():
            try:
                found.append(json.loads(line)["id"])
            except json.JSONDecodeError:
                continue
        return found

    def test_two_dask_workers_give_the_local_values(self):
        self.experiment("scene", SCENE)
        self.assert_exit(corsac(*self.words()), 0)
        local = self.result("scene")
        file = self.dir / "scheduler.json"
        env = {**os.environ, "DASK_DISTRIBUTED__LOGGING__DISTRIBUTED": "error"}
        dask = [PYTHON, "-m", "distributed.cli.dask_scheduler", "--scheduler-file", file, "--port", "0", "--no-dashboard"]
        worker = [PYTHON, "-m", "distributed.cli.dask_worker", "--scheduler-file", file, "--nthreads", "1",
                  "--no-dashboard", "--no-nanny"]
        quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL, "env": env, "cwd": self.dir}
        servers = [subprocess.Popen([str(w) for w in words], **quiet) for words in (dask, worker, worker)]
        try:
            limit = time.monotonic() + 60
            while not file.exists() and time.monotonic() < limit:
                time.sleep(0.1)
            address = json.loads(file.read_text())["address"]
            other = self.dir / "dask"
            done = corsac("lab", "--experiments", self.dir / "lab", "--out", other, "--scheduler", address)
            self.assert_exit(done, 0)
        finally:
            for server in reversed(servers):
                server.kill()
                server.wait(20)
        self.assertEqual(self.result("scene", other)["rows"], local["rows"])


if __name__ == "__main__":
    unittest.main()
