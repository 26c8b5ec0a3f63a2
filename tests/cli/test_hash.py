"""One hash: threads, instruction sets, compilers, with and without a window, with pictures."""

import re
import subprocess
import unittest
from pathlib import Path

from scenes import BALLS
from support import CORSAC, ROOT, SceneCase

FLAGS = {"sse2": "sse2", "avx2": "avx2", "avx512": "avx512f"}


class Hash(SceneCase):
    def hash(self, *args, **options):
        done = self.run_scene(BALLS, "--steps", 120, "--set", "n=60", "--hash", "--quiet", *args, **options)
        self.assert_exit(done, 0)
        self.assertRegex(done.out, re.compile(r"\A[0-9a-f]{16}\n\Z"))
        return done.out

    def test_threads(self):
        self.assertEqual({self.hash("--threads", n) for n in (1, 2, 4)}, {self.hash()})

    def test_instruction_sets(self):
        have = Path("/proc/cpuinfo").read_text().split()
        sets = [name for name, flag in FLAGS.items() if flag in have]
        self.assertIn("sse2", sets)
        self.assertEqual(len({self.hash("--simd", name) for name in sets}), 1)

    def test_the_seed_matters(self):
        self.assertNotEqual(self.hash("--seed", 1), self.hash("--seed", 2))

    def test_pictures_do_not_matter(self):
        self.assertEqual(self.hash("--shot", self.dir / "a.png@60", "--size", "64x64"), self.hash())

    def test_a_window_does_not_matter(self):
        self.assertEqual(self.hash("--size", "160x120", window=True), self.hash())

    def test_the_processor_that_libm_sees_does_not_matter(self):
        self.assertEqual(self.hash(env={"GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2_Usable,-FMA_Usable,-AVX2,-FMA"}),
                         self.hash())

    def test_processes_agree_and_tables_keep_their_order(self):
        text = """
            local total = 0
            function corsac.fixed()
              local t = {}
              for i = 1, 40 do t["key" .. i * 7919] = math.random() end
              for k, v in pairs(t) do total = (total * 3 + v * #k) % 1 end
              corsac.metrics.set("total", total)
            end
            function corsac.load()
              corsac.scene.spawn{ body = { shape = "sphere", radius = 0.5 } }
            end"""
        seen = set()
        for _ in range(5):
            done = self.run_scene(text, "--steps", 20, "--metrics", "-")
            self.assert_exit(done, 0)
            seen.add(re.search(r'"total": (\S+)', done.out.split('"user"')[1]).group(1))
        self.assertEqual(len(seen), 1, seen)

    def test_the_other_compiler_agrees(self):
        other = ROOT / "build/clang-release/corsac"
        if not other.exists() or str(other) == CORSAC:
            self.skipTest("build/clang-release/corsac is not built (make CC=clang)")
        if other.stat().st_mtime < Path(CORSAC).stat().st_mtime:
            self.skipTest("build/clang-release/corsac is older than the program (make CC=clang)")
        scene = self.write("scene.lua", BALLS)
        out = subprocess.run([other, "run", scene, "--headless", "--steps", "120", "--set", "n=60", "--hash",
                              "--quiet"], cwd=ROOT, capture_output=True, text=True, timeout=120).stdout
        self.assertEqual(out, self.hash())


if __name__ == "__main__":
    unittest.main()
