"""corsac.save: written whole, read back, versions, names that leave the folder, broken files."""

import unittest

from support import SceneCase


class Save(SceneCase):
    def play(self, body, *texts, code=0):
        done = self.run_scene(f"function corsac.load()\n{body}\nend", "--steps", 1,
                              env={"CORSAC_SAVE": str(self.dir / "player")})
        self.assert_exit(done, code, *texts)

    def test_data_comes_back(self):
        self.play("assert(corsac.save.read('slot-1') == nil)"
                  "corsac.save.write('slot-1', {score = 12.5, bag = {'rope', 'lamp'}})")
        self.play("local d = corsac.save.read('slot-1') assert(d.score == 12.5 and d.bag[2] == 'lamp')")

    def test_old_data_is_migrated(self):
        self.play("corsac.save.write('a', {points = 3})")
        self.play("corsac.save.read('a', {version = 2})", "has version 1, this game reads version 2", code=1)
        self.play("local d = corsac.save.read('a', {version = 2, migrate = function(d, v) return "
                  "{score = d.points * 10 + v} end}) assert(d.score == 31)")
        self.play("corsac.save.write('a', {score = 1}, 9) corsac.save.read('a')",
                  "has version 9, this game reads version 1", code=1)

    def test_names_cannot_leave_the_folder(self):
        for name in ("../x", "/etc/passwd", "a/b", "", "a.lua"):
            self.play(f"corsac.save.write('{name}', {{}})", "a name has 1 to 64 letters", code=1)

    def test_only_plain_data_is_written(self):
        self.play("corsac.save.write('a', {f = print})", "corsac.save.write: data.data.f is a function", code=1)
        self.play("local t = {} t.t = t corsac.save.write('a', t)", "nested too deeply", code=1)

    def test_a_broken_file_is_an_error_and_no_crash(self):
        for text in ('{"version": 1, "data": {', "[" * 5000, "\0\1\2", '{"version": "x"}', ""):
            self.write("player/a.json", text)
            self.play("corsac.save.read('a')", "corsac.save.read: ", code=1)


if __name__ == "__main__":
    unittest.main()
