"""Mods on the command line: order, conflicts, dependencies, failures, figures, replay."""

import json
import unittest

from support import SceneCase, corsac

GAME = """
local data
function corsac.load()
    data = corsac.mods.data("rules", { gravity = -9.81, names = { a = 1 } })
    corsac.phys.setGravity(0, data.gravity, 0)
    corsac.phys.newBody{ shape = "sphere", position = { 0, 5, 0 } }
end
function corsac.fixed() corsac.metrics.set("gravity", data.gravity) end
"""


class Mods(SceneCase):
    def mod(self, name, code, **manifest):
        fields = ", ".join(f"{key} = {value}" for key, value in manifest.items())
        self.write(f"{name}/mod.lua", f'return {{ name = "{name}", {fields} }}')
        return ["--mod", self.write(f"{name}/main.lua", code).parent]

    def play(self, *args, code=0):
        metrics = self.dir / "metrics.json"
        done = self.run_scene(GAME, "--steps", 20, "--metrics", metrics, "--hash", *args)
        self.assert_exit(done, code)
        return json.loads(metrics.read_text(encoding="utf-8")), done

    def test_order_decides_and_conflicts_are_told(self):
        early = self.mod("early", 'corsac.mod.patch("rules", { gravity = -1 })', order=1)
        late = self.mod("late", 'corsac.mod.patch("rules", { gravity = -2 })', order=2)
        data, done = self.play(*late, *early)
        self.assertEqual(data["user"]["gravity"], -2)
        self.assertIn("mods early and late both set rules.gravity; late wins", done.err)
        self.assertEqual([mod["name"] for mod in data["mods"]], ["early", "late"])

    def test_dependencies_go_first_and_missing_ones_leave_the_mod_out(self):
        first = self.mod("zlib", 'corsac.log("zlib runs")')
        second = self.mod("addon", 'corsac.log("addon runs")', dependencies='{ "zlib" }')
        _, done = self.play(*second, *first)
        self.assertLess(done.err.index("zlib runs"), done.err.index("addon runs"))
        data, done = self.play(*second)
        self.assertIn('mod addon: left out; it needs the mod "zlib"', done.err)
        self.assertEqual(data["mods"], [])

    def test_a_failing_mod_leaves_exit_code_and_hash_as_they_are(self):
        plain, _ = self.play()
        broken = self.mod("broken", 'corsac.mod.before("fixed", function() '
                          'corsac.phys.newBody{ shape = "box" } error("no luck") end)')
        data, done = self.play(*broken)
        self.assertEqual(data["hash"], plain["hash"])
        self.assertIn("mod broken: broken/main.lua:1: no luck", done.err)
        self.assertEqual((data["mods"][0]["errors"], data["mods"][0]["enabled"]), (20, True))

    def test_figures_tell_what_a_mod_used(self):
        busy = self.mod("busy", 'corsac.mod.after("fixed", function() for i = 1, 10000 do end end)')
        data, _ = self.play(*busy)
        mod = data["mods"][0]
        self.assertGreaterEqual(mod["instructions"], 20 * 10000)
        self.assertGreaterEqual(mod["calls"], 20)
        self.assertGreater(mod["bytes"], 10000)

    def test_a_file_of_the_mod_hides_the_games(self):
        skin = self.mod("skin", "")
        self.write("skin/assets/motto.txt", "from the mod")
        self.write("motto.txt", "from the game")
        done = self.run_scene('corsac.log(corsac.readFile("motto.txt")) '
                              'function corsac.load() corsac.log(corsac.readFile("motto.txt")) end',
                              "--steps", 1, *skin)
        self.assert_exit(done, 0, "from the game", "from the mod")

    def test_two_mods_with_one_asset_are_told_and_the_later_wins(self):
        early, late = self.mod("early", "", order=1), self.mod("late", "", order=2)
        for name in ("early", "late"):
            self.write(f"{name}/assets/text/motto.txt", f"of {name}")
        done = self.run_scene('function corsac.load() corsac.log(corsac.readFile("text/motto.txt")) end',
                              "--steps", 1, *late, *early)
        self.assert_exit(done, 0, "of late",
                         "mods early and late both have assets/text/motto.txt; late wins")

    def test_mods_of_the_games_folder_are_loaded_by_themselves(self):
        self.write("game/main.lua", GAME)
        for name, order in (("b_first", 1), ("a_second", 2)):
            self.write(f"game/mods/{name}/mod.lua", f'return {{ name = "{name}", order = {order} }}')
            self.write(f"game/mods/{name}/main.lua", f'corsac.log("{name} runs")')
        self.write("game/mods/notes.txt", "no mod")
        metrics = self.dir / "metrics.json"
        run = ["run", self.dir / "game", "--headless", "--steps", 5, "--metrics", metrics]
        self.assert_exit(corsac(*run), 0, "b_first runs")
        names = [mod["name"] for mod in json.loads(metrics.read_text(encoding="utf-8"))["mods"]]
        self.assertEqual(names, ["b_first", "a_second"])
        self.assert_exit(corsac(*run, "--mod", self.dir / "game/mods/../mods/b_first"), 0)
        # the file itself is a scene, not a game: nothing but what is named is loaded
        self.assert_exit(corsac("run", self.dir / "game/main.lua", "--headless", "--steps", 1,
                                "--metrics", metrics), 0)
        self.assertEqual(json.loads(metrics.read_text(encoding="utf-8"))["mods"], [])

    def test_assets_that_hold_code_are_refused(self):
        sly = self.mod("sly", "")
        self.write("sly/assets/deep/main.lua", "corsac.exit(9)")
        self.assert_exit(self.run_scene(GAME, *sly), 2, "assets hold no .lua files")

    def test_a_mod_adds_states_to_a_machine(self):
        game = """
        local fox, clip
        local function wave(name, height)
            return corsac.anim.newClip{ skeleton = fox, name = name, duration = 0.2, keys = {
                { bone = "root", time = 0, position = { 0, 0, 0 } },
                { bone = "root", time = 0.1, position = { 0, height, 0 } } } }
        end
        function corsac.load()
            fox = corsac.anim.newSkeleton{ { name = "root" } }
            local machine = corsac.anim.newMachine{ states = { { name = "idle", clip = wave("idle", 1) } } }
            clip = wave("dance", 2)
            corsac.emit("machines", { fox = machine, dance = clip })
            animator = corsac.anim.newAnimator(fox, machine)
        end
        function corsac.fixed()
            pcall(animator.send, animator, "party") -- unknown without the mod
            corsac.metrics.set("dancing", animator:getState() == "dance" and 1 or 0)
        end
        """
        code = """
        corsac.mod.after("machines", function(parts)
            parts.fox:extend{
                states = { { name = "dance", clip = parts.dance,
                             onEnter = function(who) corsac.log("dances") end } },
                transitions = { { from = "idle", to = "dance", event = "party" } } }
            %s
        end)"""
        metrics = self.dir / "metrics.json"
        for extra, dancing in (("", 1), ('error("no luck")', 0)):
            dancer = self.mod("dancer", code % extra)
            done = self.run_scene(game, "--steps", 10, "--metrics", metrics, *dancer)
            self.assert_exit(done, 0, "dances" if dancing else "no luck")
            self.assertEqual(json.loads(metrics.read_text(encoding="utf-8"))["user"]["dancing"], dancing)
        greedy = self.mod("greedy", """corsac.mod.after("machines", function(parts)
            for i = 1, 300 do
                parts.fox:extend{ states = { { name = "s" .. i, clip = parts.dance } } }
            end
        end)""")
        self.assert_exit(self.run_scene(game, "--steps", 2, *greedy), 0, "to 16 in one call")

    def test_a_mod_that_is_not_there_is_an_error_of_usage(self):
        self.assert_exit(self.run_scene(GAME, "--mod", self.dir / "none"), 2)

    def test_a_recording_knows_its_mods(self):
        scene, record = self.write("scene.lua", GAME), self.dir / "run.rec"
        moon = self.mod("moon", 'corsac.mod.after("load", function() corsac.phys.setGravity(0, -1, 0) end)')
        run = ["run", scene, "--headless", "--steps", 20]
        self.assert_exit(corsac(*run, "--record", record, *moon), 0)
        self.assert_exit(corsac("run", scene, "--headless", "--replay", record, *moon), 0)
        without = corsac("run", scene, "--headless", "--replay", record)
        self.assert_exit(without, 4, "moon/main.lua")


if __name__ == "__main__":
    unittest.main()
