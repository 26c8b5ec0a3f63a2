"""What a script's author reads when something is wrong: the texts themselves, with place and help."""

import unittest

from support import SceneCase

SPAWN = "corsac.scene.spawn: argument 1 (options)"

# Line 2 of the scene, inside corsac.load, and the message after "scene.lua:2: ".
IN_LOAD = [
    ('corsac.phys.setGravity(0, "down", 0)',
     'corsac.phys.setGravity: argument 2 (y): expected a number in m/s^2, got the string "down"'),
    ("corsac.phys.setGravity(0, -9.81)",
     "corsac.phys.setGravity: argument 3 (z): expected a number in m/s^2, got nothing (nil)"),
    ("corsac.phys.setGravity(0, 0/0, 0)",
     "corsac.phys.setGravity: argument 2 (y): expected a number in m/s^2, got the number "),
    ("corsac.phys.setGravity(0, 1, 2, 3)", "corsac.phys.setGravity: expected 3 arguments, got 4"),
    ("corsac.phys.setGravty(0, 1, 0)", 'corsac.phys has no "setGravty"; did you mean "setGravity"?'),
    ("corsac.pyhs.setGravity(0, 1, 0)", 'corsac has no "pyhs"; did you mean "phys"?'),
    ("corsac.scene.spawn{ postion = {1, 2, 3} }",
     SPAWN + ': unknown field "postion"; did you mean "position"?'),
    ('corsac.scene.spawn{ body = { shape = "shpere" } }',
     SPAWN + ', field body.shape: "shpere" is unknown; did you mean "sphere"?'),
    ('corsac.scene.spawn{ body = { shape = "torus" } }',
     SPAWN + ', field body.shape: "torus" is unknown; expected one of "sphere", "box"'),
    ("corsac.scene.spawn{ position = {1, 2} }", SPAWN + ", field position: expected three finite numbers"),
    ("corsac.scene.spawn{ position = 5 }",
     SPAWN + ", field position: expected a table {x, y, z} in m, got the number 5"),
    ('corsac.scene.spawn{ body = { shape = "sphere", radius = -1 } }',
     SPAWN + ", field body.radius: expected a number in m, > 0, got the number -1"),
    ('corsac.scene.spawn{ body = { shape = "box", radius = 1 } }',
     'corsac.scene.spawn: body: a box has no "radius"; it takes size'),
    ("corsac.scene.spawn{ body = {} }", "corsac.scene.spawn: body: the body has no shape"),
    ("corsac.scene.spawn(7)", SPAWN + ": expected a table of options, got the number 7"),
    ("corsac.scene.spawn{ 1, 2 }", SPAWN + ": expected named fields only"),
    ("local e = corsac.scene.spawn{} e:getPositon()",
     'Entity has no "getPositon"; did you mean "getPosition"?'),
    ("local e = corsac.scene.spawn{} e.getPosition()",
     "Entity:getPosition: expected an Entity before the colon, got nothing (nil)"),
    ("local e = corsac.scene.spawn{} e.hp = 3", 'Entity holds no fields of yours ("hp")'),
    ("local e = corsac.scene.spawn{} e:destroy() e:getPosition()",
     "Entity:getPosition: this Entity was destroyed"),
    ("local e = corsac.scene.spawn{} e:destroy() corsac.scene.spawn{ parent = e }",
     SPAWN + ", field parent: this Entity was destroyed"),
    ("function corsac.udpate() end", 'corsac has no callback "udpate"; did you mean "update"?'),
    ("corsac.update = 5", "corsac.update must be a function, got a number"),
    ('corsac.gfx.print("hi", 1, 2)',
     "corsac.gfx.print cannot be called from corsac.load; call it from corsac.draw"),
    ("os.time()", "os.time reads the wall clock, which would make every run different"),
    ('setmetatable({}, { __mode = "k" })', "setmetatable: __mode and __gc depend on when the collector runs"),
    ("for k in pairs{ [{}] = 1 } do end", "this table has a table as key"),
    ("string.format('%p', {})", "string.format: %p would print an address"),
    ('require("enemies.bat")', 'require: no file "enemies/bat.lua" or "enemies/bat/init.lua"'),
    ('corsac.expect("accuracy.nna", "==", 0)', 'corsac.expect: no metric "accuracy.nna"'),
    ('corsac.expect("accuracy.nan", "=", 0)', 'corsac.expect: argument 2 (op): "=" is unknown'),
    ("corsac.wait(1)", "corsac.wait works inside corsac.spawn(function() ... end)"),
    ('corsac.set("phys.sover", "soft")', "phys setting 'sover' is unknown, did you mean solver"),
    ("corsac.after(-1, print)",
     "corsac.after: argument 1 (seconds): expected a number in s, >= 0, got the number -1"),
    ("corsac.run(5)", "corsac.run: argument 1 (path): expected a string, got the number 5"),
    ("local x = nil; x.y = 1", "attempt to index local 'x' (a nil value)"),
    ('corsac.scene.find("a\\0b")',
     'corsac.scene.find: argument 1 (name): the string "a" goes on behind a zero byte'),
    ('corsac.json.encode({ x = "a\\0b" })', "corsac.json.encode: value.x is a string with a zero byte"),
    ("error({})", ""),
]


class Errors(SceneCase):
    def test_messages_say_what_was_expected_and_where(self):
        for code, message in IN_LOAD:
            with self.subTest(code=code):
                done = self.run_scene(f"function corsac.load()\n{code}\nend", "--steps", 1)
                place = "scene.lua:2: " if message else "error raised with a table instead of a text"
                self.assert_exit(done, 1, place + message)

    def test_a_misspelt_global_names_the_nearest(self):
        done = self.run_scene("local player = 1\nfunction corsac.load()\n    corsca.log(1)\nend", "--steps", 1)
        self.assert_exit(done, 1, "scene.lua:3: attempt to index global 'corsca' (a nil value); "
                         "did you mean 'corsac'?")

    def test_the_traceback_tells_the_way_to_the_error(self):
        done = self.run_scene("local function inner()\n    error('here')\nend\n"
                              "function corsac.fixed() inner() end", "--steps", 3)
        self.assert_exit(done, 1, "scene.lua:2: here", "scene.lua:2: in 'inner'", "scene.lua:4: in a function",
                         "called as corsac.fixed")
        self.assertEqual(done.err.count("scene.lua:2: here"), 1 + done.err.count("warning: "), str(done))

    def test_the_simulation_is_not_changed_from_update_draw_or_event(self):
        for callback in ("update", "draw"):
            done = self.run_scene(f"function corsac.{callback}()\n    corsac.phys.setGravity(0, 0, 0)\nend",
                                  "--steps", 1, "--shot", self.dir / "a.png")
            if done.code == 5:
                self.skipTest("no GL here")
            self.assert_exit(done, 1, f"corsac.phys.setGravity changes the simulation, which corsac.{callback} "
                             "must not do; call it from corsac.fixed (or corsac.load)")

    def test_worlds_do_not_exist_at_top_level(self):
        done = self.run_scene("corsac.phys.setGravity(0, 0, 0)", "--steps", 1)
        self.assert_exit(done, 1, "corsac.phys.setGravity needs the world, which does not exist yet in the "
                         "file's own code; call it from corsac.load")

    def test_a_syntax_error_has_its_line(self):
        self.assert_exit(self.run_scene("x = 1\ny = = 2", "--steps", 1), 1, "scene.lua:2: unexpected symbol near '='")

    def test_an_error_in_a_timer_a_coroutine_or_a_listener_has_its_place(self):
        for code in ("corsac.after(0.01, function()\nerror('late') end)",
                     "corsac.spawn(function() corsac.wait(0.01)\nerror('late') end)",
                     "corsac.on('x', function()\nerror('late') end) corsac.emit('x')"):
            with self.subTest(code=code):
                done = self.run_scene(f"function corsac.load() {code} end", "--steps", 5)
                self.assert_exit(done, 1, "scene.lua:2: late")

    def test_parameters_keep_the_type_of_their_default(self):
        text = "local n = corsac.param('n', 5)\nfunction corsac.load() corsac.log('n is ' .. n) end"
        self.assert_exit(self.run_scene(text, "--steps", 1, "--set", "n=7.5"), 0, "n is 7.5")
        self.assert_exit(self.run_scene(text, "--steps", 1, "--set", "n=many"), 1,
                         "--set n=many: expected a number, as the default 5 is")

    def test_conf_is_checked_too(self):
        for line, message in (("t.stpes = 5", 'unknown field "stpes"; did you mean "steps"?'),
                              ("t.dt = 3", "field dt: expected a number in s, 1e-05 to 1, got the number 3"),
                              ("t.size = { 5 }", "corsac.conf: size: expected {width, height}")):
            with self.subTest(line=line):
                self.assert_exit(self.run_scene(f"function corsac.conf(t) {line} end"), 1, message)


if __name__ == "__main__":
    unittest.main()
