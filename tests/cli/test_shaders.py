"""Shaders of a game: passes and materials from Lua, their errors, pictures of passes, mods kept out."""

import unittest

import png
from support import SceneCase

SCENE = """
local gfx = corsac.gfx
function corsac.load()
    gfx.setBackground(0.5, 0.5, 0.5)
    gfx.set("tonemap", "linear")
    %s
    corsac.scene.spawn{ mesh = "sphere", position = { 0, 0, -4 } }
    gfx.lookAt(0, 0, 0, 0, 0, -1)
end
"""
EFFECT = 'vec3 effect(vec2 uv) { return uv.x < 0.5 ? vec3(1.0, 0.0, 0.0) : vec3(parameter(1)); }'


class Shaders(SceneCase):
    def picture(self, code, *args, exit_code=0, shot="x.png"):
        self.write("fx/split.glsl", EFFECT)
        out = self.dir / shot
        done = self.run_scene(SCENE % code, "--steps", 2, "--size", "64x48", "--shot", out, *args)
        self.assert_exit(done, exit_code)
        return done, self.dir / shot.split(":")[0]

    def test_a_pass_with_parameters(self):
        _, out = self.picture('gfx.newEffect{ fragment = "fx/split.glsl", parameters = { 9, 1 } }')
        _, _, _, rows = png.read(out)
        self.assertEqual(list(rows[24][:3]), [255, 0, 0])
        self.assertEqual(list(rows[24][-4:-1]), [255, 255, 255])

    def test_an_error_names_file_and_line(self):
        self.write("fx/bad.glsl", "\n\nvoid surface(inout Look look) { look.colour = 1.0; }\n")
        done, _ = self.picture('gfx.newMaterial{ fragment = "fx/bad.glsl" } '
                               'corsac.scene.spawn{ mesh = "box", position = { 0, 0, -3 }, '
                               'material = gfx.newMaterial{ fragment = "fx/bad.glsl" } }')
        self.assertIn("fx/bad.glsl:3:", done.err)
        done, _ = self.picture('gfx.newEffect{ fragment = "fx/none.glsl" }', exit_code=1)
        self.assertIn('there is no file "fx/none.glsl"', done.err)
        done, _ = self.picture('gfx.newEffect{ fragment = "fx/split.glsl", parameters = '
                               '{ 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17 } }', exit_code=1)
        self.assertIn("17 parameters, expected at most 16", done.err)

    def test_pictures_of_passes(self):
        _, out = self.picture('gfx.set("ao", 1)', shot="ao.png:ao@2")
        width, height, _, rows = png.read(out)
        self.assertEqual((width, height), (64, 48))
        self.assertEqual(list(rows[0][:4]), [255, 255, 255, 255])  # nothing is there to occlude
        done, _ = self.picture("", shot="ao.png:ao", exit_code=2)
        self.assertIn('the pass "ao" did not run', done.err)
        done, _ = self.picture("", shot="ao.png:blom", exit_code=2)
        self.assertIn('did you mean "bloom"', done.err)

    def test_mods_bring_no_shaders(self):
        self.write("evil/mod.lua", 'return { name = "evil" }')
        self.write("evil/fx.glsl", EFFECT)
        for call, message in (("newEffect", 'corsac.gfx has no "newEffect"'), ("newMaterial", "mods may not bring shaders")):
            code = f'corsac.mod.before("fixed", function() corsac.gfx.{call}{{ fragment = "evil/fx.glsl" }} end)'
            folder = self.write("evil/main.lua", code).parent
            done, _ = self.picture("", "--mod", folder)
            self.assertIn(message, done.err)

    def test_settings_take_lua_values(self):
        done, _ = self.picture('gfx.set("fxaa", true) gfx.set("lift", { 0.1, 0, 0 }) gfx.set("ao", 0.5)')
        self.assertEqual(done.code, 0)
        done, _ = self.picture('gfx.set("fxaa", print)', exit_code=1)
        self.assertIn("expected a string, a number, true, false or {r, g, b}, got a function", done.err)


if __name__ == "__main__":
    unittest.main()
