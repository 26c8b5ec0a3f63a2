"""corsac.scene.save and load: a whole scene, in both forms, from Lua; recorded; damaged."""

import json
import shutil
import unittest

import png
from support import ROOT, SceneCase, corsac

SCENE = """
local at, from = corsac.param("at", -1), corsac.param("from", -1)
local kept = corsac.persist("purse", { coins = 0 })
local same = kept
function corsac.load()
  corsac.scene.spawn{ position = { 0, -0.5, 0 }, mesh = "box",
    body = { type = "static", shape = "box", size = { 30, 1, 30 } } }
  for i = 1, 30 do
    corsac.scene.spawn{ position = { 3 * math.random(), 1 + 0.6 * i, 3 * math.random() }, mesh = "sphere",
      body = i % 2 == 0 and { shape = "sphere", radius = 0.3 } or { shape = "box", size = 0.5 } }
  end
  corsac.gfx.newLight{ position = { 0, 4, 0 }, intensity = 30 }
end
function corsac.fixed()
  local step = corsac.getStep()
  kept.coins = kept.coins + 1
  if step == at then corsac.scene.save("slot", corsac.param("form", "binary")) end
  if step == from then corsac.metrics.set("found", corsac.scene.load("slot") and 1 or 0) end
  if step % 7 == 0 then
    corsac.scene.spawn{ position = { math.random(), 8, 0 }, mesh = "sphere", body = { shape = "sphere", radius = 0.2 } }
  end
end
function corsac.update()
  corsac.metrics.set("coins", same.coins)
  corsac.metrics.set("time", corsac.getTime())
end
corsac.on("loaded", function(name) corsac.log("loaded " .. name .. " at step " .. corsac.getStep()) end)
"""
SCENE = SCENE.replace('corsac.param("form", "binary")', "form").replace(
    "local kept", 'local form = corsac.param("form", "binary")\nlocal kept')


class SceneSave(SceneCase):
    def setUp(self):
        super().setUp()
        self.env = {"CORSAC_SAVE": str(self.dir / "player")}

    def go(self, steps, *args, **options):
        done = self.run_scene(SCENE, "--steps", steps, "--metrics", "-", *args, env=self.env, **options)
        self.assertEqual(done.code, 0, str(done))
        return json.loads(done.out), done.err

    def test_both_forms_restore_hash_time_and_persisted_tables(self):
        later, _ = self.go(260)
        for form in ("binary", "lua"):
            saved, _ = self.go(100, "--set", "at=99", "--set", f"form={form}")
            loaded, err = self.go(20, "--set", "from=19")  # at the end of its 20th step it is where that was
            self.assertIn("loaded slot at step 100", err)
            self.assertEqual((loaded["hash"], loaded["user"]["found"]), (saved["hash"], 1))
            went_on, _ = self.go(180, "--set", "from=19", "--threads", 1)  # 20, then 160 from the 100th on
            self.assertEqual(went_on["hash"], later["hash"])
            self.assertEqual(went_on["user"]["coins"], 260)
            self.assertAlmostEqual(went_on["user"]["time"], later["user"]["time"], delta=1e-9)
            (self.dir / "player/slot.csave").unlink(missing_ok=True)

    def test_feet_and_ragdolls_are_where_they_were(self):
        text = """
            local at, from, falls = corsac.param("at", -1), corsac.param("from", -1), corsac.param("falls", false)
            function corsac.load()
              for i = 0, 5 do
                corsac.phys.newBody{ type = "static", shape = "box", size = { 2, 1, 0.2 },
                  position = { 0, 0.03 * i - 0.58, 0.2 * i - 0.5 } }
              end
              local model = corsac.anim.loadModel("models/fox.cmodel")
              fox = corsac.scene.spawn{ model = model, clip = model:getClip("walk") }
            end
            function corsac.fixed()
              local step, animator = corsac.getStep(), fox:getAnimator()
              if step == 10 and falls then
                animator:startRagdoll{ mass = 8 }
              elseif step == 10 then
                animator:setFeet{ bones = { "hind_paw_l", "front_paw_r" }, root = "hips" }
              end
              if step == 45 and falls then animator:stopRagdoll(0.2) end
              if step == at then corsac.scene.save("fox") end
              if step == from then
                from = -1
                corsac.scene.load("fox")
              end
            end"""

        def go(steps, *args):
            done = self.run_scene(text, "--steps", steps, "--hash", "--quiet", *args, env=self.env)
            self.assert_exit(done, 0)
            return done.out
        for falls in ("false", "true"):
            for at in (5, 10, 30, 50):  # before, in the step, after; getting up
                with self.subTest(falls=falls, at=at):
                    what = ("--set", f"falls={falls}")
                    saved, later = go(at + 1, "--set", f"at={at}", *what), go(60, *what)
                    self.assertEqual(go(20, "--set", "from=19", *what), saved)
                    self.assertEqual(go(20 + 59 - at, "--set", "from=19", *what), later)

    def test_the_picture_is_that_of_the_save(self):
        shots = [self.dir / "saved.png", self.dir / "loaded.png"]
        self.go(101, "--set", "at=99", "--size", "160x90", "--shot", shots[0])
        self.go(21, "--set", "from=19", "--size", "160x90", "--shot", shots[1])
        self.assertEqual(png.compare(*shots, 0), 0)

    def test_the_text_form_is_lua_and_an_edit_counts(self):
        self.go(100, "--set", "at=99", "--set", "form=lua")
        path = self.dir / "player/slot.lua"
        text = path.read_text()
        for part in ("return {", '["phys.bodies"] = {', "gravity = { 0, -9.81000042, 0 },", r"\034coins\034:100"):
            self.assertTrue(part in text, part)
        path.write_text(text.replace("gravity = { 0, -9.81000042, 0 }", "gravity = { 0, 2, 0 }"))
        scene = SCENE + """
            local up = corsac.fixed
            function corsac.fixed() up() local _, y = corsac.phys.getGravity() corsac.metrics.set("gravity", y) end"""
        done = self.run_scene(scene, "--steps", 25, "--set", "from=19", "--metrics", "-", env=self.env)
        self.assert_exit(done, 0)
        self.assertEqual(json.loads(done.out)["user"]["gravity"], 2)

    def test_a_missing_save_is_false_and_a_damaged_one_an_error_that_changes_nothing(self):
        missing, _ = self.go(30, "--set", "from=19")
        self.assertEqual(missing["user"]["found"], 0)
        self.go(100, "--set", "at=99")
        path = self.dir / "player/slot.csave"
        data = bytearray(path.read_bytes())
        data[len(data) // 2] ^= 4
        path.write_bytes(data)
        done = self.run_scene(SCENE, "--steps", 30, "--set", "from=19", env=self.env)
        self.assert_exit(done, 1, "slot.csave: header: the checksum is another; the file is damaged")
        kept = self.run_scene(SCENE, "--steps", 30, "--set", "from=19", "--keep-going", "--hash", "--quiet", env=self.env)
        self.assertEqual(kept.out.strip(), missing["hash"])

    def test_a_save_of_another_scene_is_refused(self):
        self.go(100, "--set", "at=99")
        other = """
            function corsac.load()
              corsac.audio.newSource{ sound = corsac.audio.newSound("sounds/hum.wav"), loop = true }
              corsac.scene.load("slot")
            end"""
        done = self.run_scene(other, "--steps", 5, env=self.env)
        self.assert_exit(done, 1, "slot.csave: rooms: saved when the scene had other rooms")

    def test_a_recording_holds_the_file_that_was_loaded(self):
        self.go(100, "--set", "at=99")
        file = self.dir / "run.crr"
        was = self.run_scene(SCENE, "--steps", 60, "--set", "from=19", "--record", file, "--hash", "--quiet", env=self.env)
        (self.dir / "player/slot.csave").unlink()
        again = self.run_scene(SCENE, "--replay", file, "--hash", "--quiet", env=self.env)
        self.assertEqual((again.code, again.out), (0, was.out), str(again))

    def test_the_whole_game_in_a_new_process_and_in_one_that_went_on(self):
        game = self.dir / "game"
        shutil.copytree(ROOT / "scripts/game", game)
        with open(game / "main.lua", "a", encoding="utf-8") as file:
            file.write("""
                local at, from, fixed = corsac.param("at", -1), corsac.param("from", -1), corsac.fixed
                function corsac.fixed(dt)
                  fixed(dt)
                  if corsac.getStep() == at then corsac.scene.save("slot") end
                  if corsac.getStep() == from then corsac.scene.load("slot") end
                end""")
        hashes = []
        for steps, setting in ((400, "at=399"), (30, "from=29"), (500, "from=499")):
            done = corsac("run", game, "--headless", "--steps", steps, "--set", setting, "--hash", "--quiet", env=self.env)
            self.assert_exit(done, 0)
            hashes.append(done.out.strip())
        self.assertEqual(len(set(hashes)), 1, hashes)

    def test_names_are_checked(self):
        done = self.run_scene('function corsac.load() corsac.scene.save("../slot") end', "--steps", 2, env=self.env)
        self.assert_exit(done, 1, "a name has 1 to 64 letters, digits, - or _")


if __name__ == "__main__":
    unittest.main()
