"""The scenes of rendering: golden images, and the same bytes whatever the runs and threads.

As test_picture: 0.1 % of the pixels may differ by more than 5 of 255; GOLDEN=write keeps new ones.
"""

import json
import os
import shutil
import struct
import unittest
import zlib
from pathlib import Path

import png
from support import ROOT, SceneCase, corsac, figure

GOLDEN = Path(__file__).resolve().parents[1] / "golden"
SCENES = ROOT / "scripts/scenes/gfx"
SMALL = ("--headless", "--quiet", "--size", "192x108")


class GfxScenes(SceneCase):
    def shot(self, scene, name, *args, env=None):
        out = self.dir / f"{name}.png"
        done = corsac("run", SCENES / f"{scene}.lua", *SMALL, "--shot", out, *args, env=env)
        self.assert_exit(done, 0)
        return out

    def golden(self, scene, *args):
        out, kept = self.shot(scene, scene, *args), GOLDEN / f"gfx-{scene}.png"
        if os.environ.get("GOLDEN") == "write":
            shutil.copy(out, kept)
        share = png.compare(kept, out)
        if not figure(f"gfx: golden picture {scene}, pixels off by more than 5 of 255", share, 0.001, "of all"):
            sheet = ROOT / f"out/golden-gfx-{scene}.png"
            sheet.parent.mkdir(exist_ok=True)
            png.difference(kept, out, sheet)
            self.fail(f"{100 * share:.2f} % of the pixels differ; expected, actual, difference: {sheet.name} in out/")

    def test_materials(self):
        self.golden("materials")

    def test_lights(self):
        self.golden("lights", "--steps", 3, "--set", "n=300")

    def test_shadows(self):
        self.golden("shadows")

    def test_cornell(self):
        self.golden("cornell")

    def test_sky(self):
        self.golden("sky")

    def test_soft(self):
        self.golden("soft")

    def test_marks(self):
        self.golden("marks")

    def test_menu(self):
        self.golden("menu", "--size", "480x480", "--steps", 12, "--set", "bot=true")

    def test_terrain(self):
        self.golden("terrain", "--set", "view=0.3", "--set", "points=257")

    def test_heights_of_sixteen_bits(self):
        """A height map whose steps eight bits could not hold, and what is no height map."""
        def chunk(name, data):
            return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

        grey = [0, 1, 257, 65535, 32768, 40000]
        rows = b"".join(b"\0" + struct.pack(">3H", *grey[i:i + 3]) for i in (0, 3))
        (self.dir / "hills.png").write_bytes(
            b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", 3, 2, 16, 0, 0, 0, 0))
            + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))
        done = self.run_scene("""
          function corsac.load()
            local heights, columns = corsac.gfx.readHeights("hills.png", 0, 65535)
            corsac.metrics.set("columns", columns)
            for i, y in ipairs(heights) do corsac.metrics.set("h" .. i, y) end
            local t = corsac.gfx.newTerrain{ heights = heights, columns = columns }
            corsac.metrics.set("at", t:getHeight(1, 1))
          end""", "--steps", 1, "--metrics", "-")
        self.assert_exit(done, 0)
        user = json.loads(done.out)["user"]
        self.assertEqual(user.pop("columns"), 3)
        self.assertEqual(user.pop("at"), 32768)
        for i, value in enumerate(grey, 1):
            self.assertAlmostEqual(user[f"h{i}"], value, delta=0.01)
        done = self.run_scene('function corsac.load() corsac.gfx.readHeights("conf.lua", 0, 1) end', "--steps", 1)
        self.assert_exit(done, 1, "conf.lua")

    def test_text(self):
        self.golden("text", "--size", "960x540")

    def test_particles(self):
        self.golden("particles", "--steps", 85)

    def test_particles_leave_the_simulation_alone(self):
        scene = SCENES / "particles.lua"
        hashes = {corsac("run", scene, "--headless", "--quiet", "--steps", 60, "--hash", "--set", f"n={n}").out for n in (0, 1, 3)}
        self.assertEqual(len(hashes), 1)

    def test_particles_do_not_depend_on_the_frames_drawn(self):
        """Nor on the instruction set or on threads."""
        alone = self.shot("particles", "alone", "--steps", 40).read_bytes()
        for name, more in (("often", ("--shot", f"{self.dir}/x.png@7", "--shot", f"{self.dir}/y.png@8")),
                           ("sse2", ("--simd", "sse2", "--threads", 1))):
            self.assertEqual(self.shot("particles", name, "--steps", 40, *more).read_bytes(), alone, name)

    def test_ao(self):
        self.golden("ao")

    def test_bloom(self):
        self.golden("bloom")

    def test_split(self):
        self.golden("split")

    def test_transparent(self):
        self.golden("transparent")

    def test_shader(self):
        self.golden("shader", "--steps", 20)

    def test_an_effect_of_no_strength_is_not_there(self):
        """The receipt shows it: the passes, shaders and bytes of a scene that never named it."""
        def passes(*args):
            done = corsac("run", SCENES / "ao.lua", *SMALL, "--receipt", "--shot", self.dir / "x.png", *args)
            return next(line for line in done.out.splitlines() if "passes" in line)
        self.assertNotEqual(passes(), passes("--set", "ao=0"))
        self.assertEqual(passes("--set", "ao=0"), passes("--set", "ao=0", "--set", "gfx.bloom=0"))

    def test_forward_and_clustered_give_one_picture(self):
        args = ("--steps", 2, "--set", "n=200", "--set")
        forward = self.shot("lights", "forward", *args, "method=forward")
        clustered = self.shot("lights", "clustered", *args, "method=clustered")
        self.assertEqual(forward.read_bytes(), clustered.read_bytes())

    def test_the_furnace_shows_nothing(self):
        """White spheres under a white sky: every pixel within one step of grey."""
        _, _, _, rows = png.read(self.shot("furnace", "furnace"))
        values = {v for row in rows for v in row} - {255}
        self.assertLessEqual(max(values) - min(values), 1)

    def test_without_egl_it_says_what_to_install(self):
        for name in ("__EGL_VENDOR_LIBRARY_FILENAMES", "LIBGL_DRIVERS_PATH"):
            done = corsac("run", SCENES / "lights.lua", *SMALL, "--steps", 1, "--shot", self.dir / "none.png",
                          env={name: "/nonexistent"})
            self.assert_exit(done, 5, "install libegl-mesa0")

    def test_an_absent_panorama_ends_the_run(self):
        scene = self.dir / "absent.lua"
        scene.write_text("function corsac.load() corsac.gfx.setEnvironment{panorama = 'none.hdr'} end")
        done = corsac("run", scene, *SMALL, "--steps", 1, "--shot", self.dir / "none.png")
        self.assert_exit(done, 1, "none.hdr")

    def test_same_bytes_over_runs_and_threads(self):
        pictures = set()
        for threads in ("0", "1", "2"):
            env = {"LP_NUM_THREADS": threads}
            pictures.add(self.shot("shadows", f"threads-{threads}", "--threads", max(1, int(threads)), env=env).read_bytes())
        self.assertTrue(figure("gfx: pictures that differ over runs and threads", len(pictures) - 1, 0, "pictures"))


if __name__ == "__main__":
    unittest.main()
