"""Menus: every widget by a bot's input, the same by its recording; what a panel refuses."""

import json
import unittest

from support import ROOT, SceneCase, corsac

MENU = ROOT / "scripts/scenes/gfx/menu.lua"
DID = "menu: Foxé! level start level cancel"

PANEL = """
local panel, said
function corsac.load()
  %s
end
function corsac.fixed()
  %s
end
function corsac.event(...) panel:event(...) end
function corsac.draw() panel:draw() end
"""


class Ui(SceneCase):
    def run_menu(self, *args):
        done = corsac("run", MENU, "--headless", "--steps", 20, *args)
        self.assert_exit(done, 0)
        return done

    def test_every_widget_by_recorded_input(self):
        file = self.dir / "menu.crr"
        done = self.run_menu("--set", "bot=true", "--metrics", "-", "--record", file)
        user = json.loads(done.out)["user"]
        # The slider was pulled beyond its end, the list's third row pressed, shadows switched off.
        self.assertEqual(user, {"volume": 1, "level": 3, "shadows": 0, "heard": 3})
        self.assertIn(DID, done.err)
        again = corsac("run", MENU, "--headless", "--replay", file, "--metrics", "-")
        self.assert_exit(again, 0)
        self.assertEqual(json.loads(again.out)["user"], user)
        self.assertIn(DID, again.err)

    def test_a_menu_needs_no_device_and_costs_no_allocation(self):
        metrics = json.loads(self.run_menu("--set", "bot=true", "--metrics", "-").out)
        self.assertEqual(metrics["steady_allocations"], 0)
        self.assertEqual(metrics["counts"]["draws"], 0)

    def panel(self, load, fixed="", steps=4):
        done = self.run_scene(PANEL % (load, fixed), "--steps", steps, "--metrics", "-")
        self.assert_exit(done, 0)
        return json.loads(done.out)["user"]

    def test_focus_goes_round_and_skips_what_takes_none(self):
        user = self.panel(
            """panel = corsac.ui.newPanel{ { type = "label", text = "a" }, { type = "button", name = "b" },
               { type = "gap" }, { type = "toggle", name = "c" }, { type = "slider", name = "d" } }
               local function at(name) return panel:getFocus() == name and 1 or 0 end
               local function key(k) panel:event("key", k, 1) end
               corsac.metrics.set("first", at("b"))
               key("tab") corsac.metrics.set("second", at("c"))
               key("down") key("down") corsac.metrics.set("round", at("b"))
               panel:event("key", "lshift", 1) key("tab") corsac.metrics.set("back", at("d"))
               panel:focus("c") key("space") corsac.metrics.set("toggled", panel:get("c") and 1 or 0)
               panel:set("c", false) corsac.metrics.set("set", panel:get("c") and 1 or 0)
               panel:show(false) corsac.metrics.set("hidden", panel:event("key", "space", 1) and 1 or 0)""")
        self.assertEqual(user, dict(first=1, second=1, round=1, back=1, toggled=1, set=0, hidden=0))

    def test_slider_steps_and_list_scrolls(self):
        user = self.panel(
            """local told = 0
               panel = corsac.ui.newPanel{ x = 0, y = 0, width = 336,
                 { type = "slider", name = "s", min = -1, max = 1, step = 0.25, value = 0.3,
                   change = function() told = told + 1 end },
                 { type = "list", name = "l", rows = 2, items = { "a", "b", "c", "d" } } }
               corsac.metrics.set("snapped", panel:get("s"))
               panel:event("key", "left", 1) corsac.metrics.set("less", panel:get("s"))
               panel:set("s", 0.5) corsac.metrics.set("told", told)
               panel:focus("l")
               for _ = 1, 3 do panel:event("key", "down", 1) end
               corsac.metrics.set("last", panel:get("l"))
               panel:event("key", "down", 1) corsac.metrics.set("left", panel:getFocus() == "s" and 1 or 0)
               panel:event("move", 100, 100) panel:event("scroll", 0, 1)
               panel:event("mouse", "mouse1", 1, 100, 90) corsac.metrics.set("scrolled", panel:get("l"))""")
        self.assertEqual(user, dict(snapped=0.25, less=0, told=1, last=4, left=1, scrolled=2))

    def test_a_field_edits_characters_not_bytes(self):
        user = self.panel(
            """panel = corsac.ui.newPanel{ { type = "field", name = "f", value = "aé", max = 4 } }
               local function is(text) return panel:get("f") == text and 1 or 0 end
               panel:event("key", "left", 1) panel:event("text", "ß") corsac.metrics.set("middle", is("aßé"))
               panel:event("key", "delete", 1) corsac.metrics.set("deleted", is("aß"))
               panel:event("key", "backspace", 1) panel:event("key", "home", 1) panel:event("text", "xyzzy")
               corsac.metrics.set("full", is("xyza"))""")
        self.assertEqual(user, dict(middle=1, deleted=1, full=1))

    def test_places_of_the_screen_and_picking(self):
        """A ball in the middle of the frame is where project says, and the ray through that pixel hits it."""
        done = self.run_scene("""
          local gfx, ball = corsac.gfx
          function corsac.load()
            corsac.phys.setGravity(0, 0, 0)
            corsac.scene.spawn{ position = { 0, -9, 0 }, mesh = "box" }
            ball = corsac.phys.newBody{ shape = "sphere", radius = 0.5, position = { 1, 2, -3 } }
            gfx.setCamera{ position = { 4, 5, 6 }, target = { 1, 2, -3 } }
          end
          function corsac.update()
            local w, h = gfx.getSize()
            local x, y, ahead = gfx.project(1, 2, -3)
            corsac.metrics.set("x", x / w) corsac.metrics.set("y", y / h) corsac.metrics.set("ahead", ahead)
            local ox, oy, oz, dx, dy, dz = gfx.getRay(x, y)
            local hit = corsac.phys.rayCast(ox, oy, oz, 50 * dx, 50 * dy, 50 * dz)
            corsac.metrics.set("hit", hit == ball and 1 or 0)
            local past = corsac.phys.rayCast(ox, oy, oz, 50 * dx, 50 * dy + 5, 50 * dz)
            corsac.metrics.set("past", past == ball and 1 or 0)
            local wide, high, lines = gfx.measure("one two", { size = 20, width = 40 })
            corsac.metrics.set("lines", lines) corsac.metrics.set("high", high)
          end""", "--steps", 2, "--size", "640x360", "--metrics", "-")
        self.assert_exit(done, 0)
        user = json.loads(done.out)["user"]
        self.assertAlmostEqual(user.pop("x"), 0.5, places=4)
        self.assertAlmostEqual(user.pop("y"), 0.5, places=4)
        self.assertAlmostEqual(user.pop("ahead"), 99**0.5, places=3)
        self.assertEqual(user, dict(hit=1, past=0, lines=2, high=40))

    def test_errors_name_what_is_wrong(self):
        for made, said in (('{ type = "buton" }', 'no type "buton"; did you mean "button"?'),
                           ('{ type = "button", pres = print }', 'has no "pres"; did you mean "press"?'),
                           ('{ type = "list", name = "l", items = {} }', 'list "l" needs items'),
                           ('{ type = "slider", name = "s", min = 2, max = 1 }', "min 2 is not below max 1"),
                           ('theme = { acent = { 1, 1, 1 } }', 'a theme has no "acent"; did you mean "accent"?'),
                           ('{ type = "button", press = 3 }', "widget 1 (button): press: expected a function, got the number 3"),
                           ('{ type = "slider", min = "a" }', "min: expected a number"),
                           ('theme = 4', "a panel: theme: expected a table, got the number 4"),
                           ('{ type = "list", name = "l", items = {} }', "scene.lua:1: corsac.ui: list"),
                           ('widht = 3', 'a panel has no "widht"; did you mean "width"?'),
                           ('{ type = "label", name = "a" }, { type = "gap", name = "a" }', 'two widgets are named "a"')):
            with self.subTest(made):
                done = self.run_scene(f"function corsac.load() corsac.ui.newPanel{{ {made} }} end", "--steps", 1)
                self.assert_exit(done, 1, said)
        done = self.run_scene("function corsac.load() corsac.ui.newPanel{ { type = 'button', name = 'go' } }"
                              ":focus('og') end", "--steps", 1)
        self.assert_exit(done, 1, 'no widget "og"; did you mean "go"?')


if __name__ == "__main__":
    unittest.main()
