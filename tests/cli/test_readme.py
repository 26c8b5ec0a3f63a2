"""What the README shows is what the tree holds."""

import re
import unittest

from support import ROOT, corsac

README = (ROOT / "README.md").read_text(encoding="utf-8")


class Readme(unittest.TestCase):
    def test_scene_is_hello_lua(self):
        shown = re.search(r"```lua\n(.*?)```", README, re.S).group(1)
        self.assertEqual(shown, (ROOT / "scripts/scenes/hello.lua").read_text(encoding="utf-8"))
        self.assertLessEqual(len(shown.splitlines()), 10)

    def test_scene_runs(self):
        result = corsac("run", "scripts/scenes/hello.lua", "--headless", "--steps", 60, "--hash")
        self.assertEqual(result.code, 0, str(result))
        self.assertRegex(result.out, r"\A[0-9a-f]{16}\n\Z")

    def test_options_are_real(self):
        listed = corsac("run", "--help").out
        for option in sorted(set(re.findall(r"`(--[a-z-]+)", README))):
            self.assertIn(option + " ", listed, f"README names {option}")

    def test_make_targets_are_real(self):
        targets = set(re.findall(r"^([a-z-]+):.*## ", (ROOT / "Makefile").read_text(), re.M))
        for name in ("README.md", "CONTRIBUTING.md", "CHANGELOG.md"):
            text = (ROOT / name).read_text(encoding="utf-8")
            for target in set(re.findall(r"(?:`|^)make ([a-z-]+)", text, re.M)):
                self.assertTrue(target in targets or target.startswith("check-"), f"{name}: {target}")


if __name__ == "__main__":
    unittest.main()
