"""corsac convert: what it writes, that it writes the same twice, and the traps of real files."""
import filecmp
import json
import os
import struct
import subprocess
import tempfile
import unittest

from support import CORSAC, ROOT

MODELS = os.path.join(ROOT, "..", "shared", "data", "models")


def convert(*args):
    return subprocess.run([CORSAC, "convert", *map(str, args)], capture_output=True, text=True, timeout=120)


def model(name):
    path = os.path.join(MODELS, name)
    if not os.path.exists(path):
        raise unittest.SkipTest("../shared/data/models/%s is not here" % name)
    return path


class Converted(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.out = os.path.join(self.folder.name, "a", "b")
        self.addCleanup(self.folder.cleanup)

    def convert(self, name, *more):
        result = convert(model(name), self.out, *more)
        self.assertEqual(result.returncode, 0, result.stderr)
        return result

    def report(self, name):
        with open(os.path.join(self.out, name + ".report.json")) as f:
            return json.load(f)

    def clip(self, name):
        """Duration and {bone: [times]} of a CAN1 file."""
        with open(os.path.join(self.out, name), "rb") as f:
            data = f.read()
        self.assertEqual(data[:4], b"CAN1")
        duration, _, tracks = struct.unpack_from("<fII", data, 132)
        at, times = 144, {}
        for _ in range(tracks):
            bone, keys = struct.unpack_from("<II", data, at)
            times[bone] = [struct.unpack_from("<f", data, at + 8 + 44 * k)[0] for k in range(keys)]
            at += 8 + 44 * keys
        self.assertEqual(at, len(data))
        return duration, times


class Files(Converted):
    def test_writes_everything_and_the_scene_runs(self):
        self.convert("fox.glb")
        names = set(os.listdir(self.out))
        self.assertLessEqual({"fox.cmodel", "fox.cskel", "fox_1.cmesh", "fox_Survey.canim",
                              "fox_Walk.canim", "fox_Run.canim", "fox.lua", "fox.report.json"}, names)
        report = self.report("fox")
        self.assertEqual((report["meshes"], report["triangles"]), (1, 576))
        self.assertGreaterEqual(report["bones"], 24)
        run = subprocess.run([CORSAC, "run", os.path.join(self.out, "fox.lua"), "--headless",
                              "--steps", "30", "--metrics", "-"], capture_output=True, text=True)
        self.assertEqual(run.returncode, 0, run.stderr)
        metrics = json.loads(run.stdout)
        self.assertEqual(metrics["counts"]["skeletons"], 1)
        self.assertEqual(metrics["counts"]["bones"], report["bones"])
        self.assertLess(metrics["accuracy"]["anim_error_max_m"], 1e-5 * 150)  # the fox is in cm

    def test_same_bytes_twice(self):
        path, other = model("kaykit_knight.glb"), os.path.join(self.folder.name, "c")
        self.assertEqual(convert(path, self.out).returncode, 0)
        self.assertEqual(convert(path, other).returncode, 0)
        names = sorted(os.listdir(self.out))
        self.assertEqual(names, sorted(os.listdir(other)))
        match, mismatch, errors = filecmp.cmpfiles(self.out, other, names, shallow=False)
        self.assertEqual((mismatch, errors), ([], []))
        self.assertGreater(len(match), 90)

    def test_dry_run_writes_nothing(self):
        result = self.convert("fox.glb", "--dry-run")
        self.assertFalse(os.path.exists(self.out))
        self.assertIn("3 clips", result.stdout)
        self.assertIn("dry run", result.stdout)

    def test_compressed_clips_play(self):
        self.convert("fox.glb", "--compress", "0.05")  # the fox is in cm
        notes = [n for n in self.report("fox")["changed"] if "compressed" in n]
        self.assertEqual(len(notes), 3)
        with open(os.path.join(self.out, "fox_Walk.canim"), "rb") as f:
            self.assertEqual(f.read(4), b"CAN2")
        run = subprocess.run([CORSAC, "run", os.path.join(self.out, "fox.lua"), "--headless",
                              "--steps", "400", "--metrics", "-"], capture_output=True, text=True)
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertLess(json.loads(run.stdout)["accuracy"]["anim_error_max_m_peak"], 1e-3)

    def test_import_on_demand(self):
        scene = os.path.join(self.folder.name, "scene")
        os.makedirs(scene)
        with open(model("fox.glb"), "rb") as f, open(os.path.join(scene, "a fox.glb"), "wb") as g:
            g.write(f.read())
        with open(os.path.join(scene, "main.lua"), "w") as f:
            f.write("function corsac.load() local m = corsac.anim.loadModel('a fox.glb')\n"
                    "corsac.scene.spawn{ model = m, clip = m:getClip('Walk') } end\n"
                    "corsac.expect('counts.skeletons', '==', 1)\n")
        env = dict(os.environ, XDG_CACHE_HOME=os.path.join(self.folder.name, "cache"))
        for _ in range(2):  # converted, then from the cache
            run = subprocess.run([CORSAC, "run", scene, "--headless", "--steps", "5"], env=env,
                                 capture_output=True, text=True)
            self.assertEqual(run.returncode, 0, run.stderr)
        imported = os.path.join(self.folder.name, "cache", "corsac", "import")
        self.assertEqual(len(os.listdir(imported)), 1)

    def test_usage(self):
        self.assertEqual(convert().returncode, 2)
        self.assertEqual(convert("a.glb", self.out, "--scale", "-1").returncode, 2)
        result = convert(os.path.join(self.folder.name, "absent.glb"), self.out)
        self.assertEqual(result.returncode, 2)
        self.assertIn("absent.glb", result.stderr)
        bad = os.path.join(self.folder.name, "bad.glb")
        with open(bad, "wb") as f:
            f.write(b"glTF" + bytes(40))
        result = convert(bad, self.out)
        self.assertEqual(result.returncode, 1)
        self.assertIn("bad.glb", result.stderr)


class Traps(Converted):
    def test_flood_of_zero_weights(self):
        # Vertex 0 of each mesh lists every unused bone with weight 0: no influence may be lost.
        self.convert("kaykit_knight.glb")
        self.assertFalse([n for n in self.report("kaykit_knight")["changed"] if "influences" in n])

    def test_weights_are_normalised_and_cut(self):
        self.convert("animation_with_skeleton.fbx")
        changed = " ".join(self.report("animation_with_skeleton")["changed"])
        self.assertIn("2464 vertices normalised (worst sum 1.377)", changed)
        self.assertIn("up to 6 influences", changed)
        self.convert("cesium_man.gltf")
        self.assertIn("210 vertices normalised", " ".join(self.report("cesium_man")["changed"]))

    def test_keys_that_end_early_are_not_stretched(self):
        self.convert("box_animated.gltf")
        duration, times = self.clip("box_animated_animation_0.canim")
        self.assertAlmostEqual(duration, 3.70833, places=4)
        self.assertIn(2.5, [round(t[-1], 5) for t in times.values()])

    def test_first_key_after_zero(self):
        self.convert("rigged_simple.gltf")
        _, times = self.clip("rigged_simple_animation_0.canim")
        self.assertAlmostEqual(min(t[0] for t in times.values()), 0.0416667, places=5)

    def test_step_and_cubic_are_kept(self):
        self.convert("interpolation_test.gltf")
        changed = self.report("interpolation_test")["changed"]
        self.assertEqual(sum("1 STEP" in n for n in changed), 3)
        _, times = self.clip("interpolation_test_Step_Translation.canim")
        gaps = [b - a for t in times.values() for a, b in zip(t, t[1:])]
        self.assertLess(min(gaps), 1e-6)  # a step holds until just before the next key
        self.assertGreater(max(gaps), 0.1)

    def test_pivots_and_units_of_fbx(self):
        self.convert("pab_walk.fbx")
        report = self.report("pab_walk")
        self.assertEqual(report["scale"], 0.01)
        self.assertIn("pivot nodes were folded", " ".join(report["changed"]))
        duration, _ = self.clip(next(n for n in os.listdir(self.out) if n.endswith(".canim")))
        self.assertAlmostEqual(duration, 4 / 3, places=3)
        with open(os.path.join(self.out, "pab_walk.cskel"), "rb") as f:
            self.assertNotIn(b"AssimpFbx", f.read())

    def test_poses_of_no_length(self):
        self.convert("kaykit_knight.glb")
        self.assertIn("T-Pose", " ".join(self.report("kaykit_knight")["changed"]))

    def test_what_is_not_supported_is_said(self):
        self.convert("morph_stress_test.gltf")
        self.assertIn("8 morph targets", " ".join(self.report("morph_stress_test")["dropped"]))


if __name__ == "__main__":
    unittest.main()
