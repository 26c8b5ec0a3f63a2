"""Input by a bot: keys, actions, axes, text; rebinding; recorded and replayed by the same stream."""

import json
import unittest

from support import SceneCase

CONF = """
function corsac.conf(t)
  t.actions = { jump = "space,pad_a", move = "-a,-left,d,right,pad_leftx" }
end
"""

WALK = CONF + """
local input, at, heard = corsac.input, {}, {}
local player
function corsac.load()
  corsac.phys.setGravity(0, 0, 0)
  player = corsac.scene.spawn{ name = "player", body = { shape = "sphere", radius = 0.5 } }
end
function corsac.event(name, a, b, c)
  heard[#heard + 1] = name .. ":" .. tostring(a) .. ":" .. tostring(b) .. (c and ":" .. tostring(c) or "")
end
function corsac.fixed()
  local step = corsac.getStep()
  if step == 2 then input.press("d") end
  if step == 5 then input.release("d"); input.setAxis("pad_leftx", -0.6) end
  if step == 8 then input.setAxis("pad_leftx", 0.1); input.press("pad_a"); input.move(12, 34) end
  if step == 9 then input.release("pad_a"); input.type("hé") end
  if step == 11 then input.bind("jump", "x"); input.press("x") end
  if step == 13 then input.press("mouse1") end
  at[step] = input.getAxis("move")
  corsac.metrics.set("move" .. step, at[step])
  corsac.metrics.set("jump" .. step, input.isDown("jump") and 1 or 0)
  player:getBody():setVelocity(3 * at[step], input.isDown("jump") and 2 or 0, 0)
  if step == 15 then
    corsac.metrics.set("mouse_x", input.getAxis("mouse_x"))
    corsac.log("heard " .. table.concat(heard, " "))
    corsac.log("bound " .. input.getBinding("jump") .. " " .. input.getBinding("move"))
  end
end
"""


class Input(SceneCase):
    def test_a_bot_moves_what_a_person_would(self):
        done = self.run_scene(WALK, "--steps", 16, "--metrics", "-")
        self.assert_exit(done, 0)
        user = json.loads(done.out)["user"]
        # Sent in one step, held from the next; a stick of -0.6 is half the way outside its dead zone.
        self.assertEqual([round(user[f"move{i}"], 6) for i in range(2, 11)], [0, 1, 1, 1, -0.5, -0.5, -0.5, 0, 0])
        self.assertEqual([user[f"jump{i}"] for i in range(8, 14)], [0, 1, 0, 0, 1, 1])
        self.assertEqual(user["mouse_x"], 12)
        self.assertIn("heard key:d:1 key:d:0 button:pad_a:1 move:12:34 button:pad_a:0 text:h:nil text:é:nil "
                      "key:x:1 mouse:mouse1:1:12", done.err.replace(".0", ""))
        self.assertIn("bound x -a,-left,d,right,pad_leftx", done.err)

    def test_a_tap_shorter_than_a_step_is_held_for_one(self):
        done = self.run_scene(CONF + """
            local held = {}
            function corsac.fixed()
              local step = corsac.getStep()
              if step == 3 then corsac.input.press("space") corsac.input.release("space") end
              if step == 6 then
                for _ = 1, 2 do corsac.input.press("a") corsac.input.release("a") end
              end
              held[#held + 1] = (corsac.input.isDown("jump") and "j" or "-") .. corsac.input.getAxis("move")
              if step == 9 then corsac.log(table.concat(held, " ")) end
            end""", "--steps", 10)
        self.assert_exit(done, 0, "-0 -0 -0 -0 j0 -0 -0 --1 -0 -0")

    def test_recorded_and_replayed_by_the_same_stream(self):
        file = self.dir / "walk.crr"
        first = self.run_scene(WALK, "--steps", 30, "--record", file, "--hash", "--quiet")
        self.assert_exit(first, 0)
        again = self.run_scene(WALK, "--replay", file, "--hash", "--quiet")
        self.assert_exit(again, 0)
        self.assertEqual(first.out, again.out)
        # Without its bot the scene needs the stream, and goes the same way by it.
        mute = WALK.replace('input.press("d")', "local _").replace('input.setAxis("pad_leftx", -0.6)', "local _")
        self.assertNotEqual(self.run_scene(mute, "--steps", 30, "--hash", "--quiet").out, first.out)
        by_stream = self.run_scene(mute, "--replay", file, "--hash", "--quiet")
        self.assert_exit(by_stream, 0)
        self.assertEqual(by_stream.out, first.out)

    def test_dead_zone(self):
        user = json.loads(self.run_scene(WALK, "--steps", 9, "--metrics", "-", "--set", "input.dead_zone=0.5").out)
        self.assertAlmostEqual(user["user"]["move6"], -0.2, places=6)
        self.assert_exit(self.run_scene(WALK, "--set", "input.dead_zone=2"), 2, "expected 0 to 0.9")

    def test_errors(self):
        for text, said in (('corsac.input.press("spcae")', "no key"), ('corsac.input.setAxis("a", 1)', "no key"),
                           ('corsac.input.bind("jump", "spcae")', "did you mean 'space'?"),
                           ('corsac.input.type("\\255")', "not UTF-8"), ('corsac.input.isDown("jmup")', "jmup"),
                           ('corsac.input.setCursor("gone")', "gone")):
            done = self.run_scene(CONF + f"function corsac.fixed() {text} end", "--steps", 2)
            self.assert_exit(done, 1, said, "scene.lua")
        done = self.run_scene('function corsac.update() corsac.input.press("a") end', "--steps", 2)
        self.assert_exit(done, 1, "fixed")


if __name__ == "__main__":
    unittest.main()
