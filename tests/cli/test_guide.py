"""Every block of Lua in docs/guide is run: a block is a scene, or with `file=PATH` a file beside it."""

import re
import shutil
import unittest

from support import ROOT, SceneCase, corsac

BLOCK = re.compile(r"^```lua(?: file=(\S+))?\n(.*?)^```", re.M | re.S)


class Guide(SceneCase):
    def test_every_block_runs(self):
        pages = sorted((ROOT / "docs/guide").glob("*.md"))
        self.assertGreaterEqual(len(pages), 10)
        for page in pages:
            blocks = BLOCK.findall(page.read_text(encoding="utf-8"))
            scenes = [text for name, text in blocks if not name]
            self.assertTrue(scenes or page.stem == "README", page.name)
            shutil.rmtree(self.dir / "mods", ignore_errors=True)
            for name, text in blocks:
                if name:
                    self.write(name, text)
            mods = [word for mod in sorted(self.dir.glob("mods/*")) for word in ("--mod", mod)]
            for number, text in enumerate(scenes, 1):
                with self.subTest(page=page.name, scene=number):
                    done = self.run_scene(text, "--steps", 60, "--quiet", *mods,
                                          env={"CORSAC_SAVE": str(self.dir / "player")})
                    self.assert_exit(done, 0)
                    self.assertNotIn("warning:", done.err, str(done))

    def test_links_of_the_index_lead_to_pages(self):
        index = (ROOT / "docs/guide/README.md").read_text(encoding="utf-8")
        for link in re.findall(r"\]\((\w[\w-]*\.md)\)", index):
            self.assertTrue((ROOT / "docs/guide" / link).exists(), link)


class GuideGame(SceneCase):
    GAME = "scripts/scenes/guide"

    def test_the_game_keeps_its_expectations_in_under_a_hundred_lines(self):
        self.assert_exit(corsac("run", self.GAME, "--headless", "--steps", 600), 0)
        lines = (ROOT / self.GAME / "main.lua").read_text(encoding="utf-8").splitlines()
        self.assertLess(len(lines), 100)

    def test_the_mod_changes_gravity_and_nothing_else_fails(self):
        plain = corsac("run", self.GAME, "--headless", "--steps", 60, "--hash")
        moon = corsac("run", self.GAME, "--headless", "--steps", 60, "--hash", "--keep-going",
                      "--mod", "scripts/mods/moon")
        self.assertRegex(moon.out.strip(), "^[0-9a-f]{16}$")
        self.assertNotEqual(plain.out, moon.out)


if __name__ == "__main__":
    unittest.main()
