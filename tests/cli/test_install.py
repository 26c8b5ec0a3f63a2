"""`make install` gives a tree that works from anywhere, and a library that C programs can use."""

import os
import subprocess
import tempfile
import unittest
from pathlib import Path

from support import ROOT

PROGRAM = r"""
#include "phys/phys.h"
#include <stdio.h>

int main(void) {
    phys_world_desc world_desc = phys_world_desc_default();
    phys_world *world = phys_world_create(&world_desc);
    phys_shape_desc shape = phys_shape_desc_default(PHYS_SPHERE);
    shape.radius = 0.5f;
    phys_body_desc desc = phys_body_desc_default();
    desc.position = (core_vec3){0, 10, 0};
    phys_body ball = phys_body_create(world, &desc, &shape, 1);
    core_vec3 p;
    for (int i = 0; i < 60; i++) {
        phys_world_step(world, 1.0f / 60);
    }
    if (!phys_body_position(world, ball, &p)) {
        return 1;
    }
    printf("%.3f\n", (double)p.y);
    phys_world_destroy(world);
    return 0;
}
"""


def run(command, **options):
    clean = {k: v for k, v in os.environ.items() if not k.startswith("MAKE") and k != "MFLAGS"}
    clean.update(options.pop("env", {}))
    return subprocess.run([str(word) for word in command], env=clean, stdin=subprocess.DEVNULL,
                          capture_output=True, text=True, timeout=300, **options)


class Install(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.stage = Path(folder.name)
        cls.prefix = cls.stage / "opt/corsac"
        done = run(["make", "-C", ROOT, "install", f"DESTDIR={cls.stage}", "PREFIX=/opt/corsac"])
        if done.returncode != 0:
            raise AssertionError(done.stdout + done.stderr)

    def test_program_runs_from_elsewhere(self):
        scene = self.prefix / "share/corsac/scripts/scenes/hello.lua"
        done = run([self.prefix / "bin/corsac", "run", scene, "--headless", "--steps", 10, "--hash"],
                   cwd=self.stage)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertRegex(done.stdout, r"\A[0-9a-f]{16}\n\Z")

    def test_c_program_needs_only_libm_and_threads(self):
        source = self.stage / "ball.c"
        source.write_text(PROGRAM)
        done = run(["gcc", "-std=c17", "-Wall", "-Wextra", "-Werror", source,
                    "-I", self.prefix / "include/corsac", self.prefix / "lib/libcorsac.a",
                    "-lm", "-lpthread", "-o", self.stage / "ball"])
        self.assertEqual(done.returncode, 0, done.stderr)
        done = run([self.stage / "ball"])
        self.assertEqual(done.returncode, 0, done.stderr)
        # Free fall for 1 s: g/2 for the exact path, up to g dt/2 more for symplectic Euler.
        fallen = 10 - float(done.stdout)
        self.assertGreaterEqual(fallen, 4.905 - 0.001)
        self.assertLessEqual(fallen, 4.905 * (1 + 1 / 60) + 0.001)

    def test_pkg_config(self):
        done = run(["pkg-config", "--cflags", "--libs", "corsac"],
                   env={"PKG_CONFIG_PATH": str(self.prefix / "lib/pkgconfig")})
        self.assertEqual(done.stdout.split(), ["-I/opt/corsac/include/corsac", "-L/opt/corsac/lib", "-lcorsac",
                                               "-lm", "-lpthread"])

    def test_private_headers_stay(self):
        headers = [p.name for p in (self.prefix / "include/corsac").rglob("*.h")]
        self.assertIn("phys.h", headers)
        self.assertEqual([name for name in headers if "internal" in name or name.startswith("simd_")], [])


if __name__ == "__main__":
    unittest.main()
