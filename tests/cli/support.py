"""What command line tests share: running the real program (its path is in CORSAC)."""

import json
import os
import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
CORSAC = os.environ.get("CORSAC", str(ROOT / "build/corsac"))


def figure(name, value, bound, unit):
    """A line that tests/run.py collects in out/accuracy.json; whether value <= bound."""
    print("\naccuracy: " + json.dumps({"name": name, "value": value, "bound": bound, "unit": unit}), flush=True)
    return value <= bound


class Result:
    """Exit code, stdout and stderr of one run."""

    def __init__(self, done):
        self.code, self.out, self.err = done.returncode, done.stdout, done.stderr

    def __str__(self):
        return f"exit {self.code}\n--- stdout\n{self.out}\n--- stderr\n{self.err}"


def corsac(*args, window=False, limit=120, env=None, cwd=ROOT, program=CORSAC):
    """Runs `corsac ARGS`; with window=True under xvfb-run, or skips the test where that is missing."""
    command = [str(program), *map(str, args)]
    return Result(run(command, window, cwd=cwd, env={**os.environ, **(env or {})}, timeout=limit))


def run(command, window, **options):
    """Runs a command, with window=True on an X display of its own."""
    if not window:
        return subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, text=True, **options)
    if not shutil.which("xvfb-run"):
        raise unittest.SkipTest("xvfb-run is not installed")
    for _ in range(5):  # xvfb-run -a does not lock the display number that it picks
        done = subprocess.run(["xvfb-run", "-a", *command], stdin=subprocess.DEVNULL, capture_output=True, text=True,
                              **options)
        if "Xvfb failed to start" not in done.stderr + done.stdout:
            break
    return done


class SceneCase(unittest.TestCase):
    """A test case with a folder of its own, self.dir, and helpers to run scenes from text."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.dir = Path(folder.name)

    def write(self, name, text):
        path = self.dir / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
        return path

    def run_scene(self, text, *args, **options):
        """Runs the text as a scene, headless unless window=True."""
        mode = [] if options.get("window") else ["--headless"]
        return corsac("run", self.write("scene.lua", text), *mode, *args, **options)

    def assert_exit(self, result, code, *texts):
        """The exit code, and every text in what the program wrote."""
        self.assertEqual(result.code, code, str(result))
        for text in texts:
            self.assertIn(text, result.out + result.err)
