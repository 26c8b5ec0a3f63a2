"""No shipped scene pays for what it does not use: rooms that its text never touches stay at zero."""

import json
import re
import unittest

from support import ROOT, SceneCase, corsac

# A scene uses a room when its text holds one of these words.
WORDS = {
    "phys": r"\bbody\b|\bphys\b|newBody",
    "gfx": r"\bmesh\b|\bgfx\b|\bmodel\b",
    "anim": r"\bmodel\b|\banim\b|newMachine",
    "nav": r"\bnav\b",
    "audio": r"\baudio\b",
}
STAGE = {"phys": "phys", "anim": "anim", "nav": "nav", "audio": "audio"}
COUNTS = {
    "phys": "bodies awake shapes pairs contacts joints islands triggers", "gfx": "lights clusters light_refs draws triangles",
    "anim": "skeletons bones", "nav": "nav_nodes agents paths", "audio": "voices",
}


def scenes():
    return [p for p in sorted((ROOT / "scripts/scenes").rglob("*.lua")) if "corsac.load" in p.read_text()]


class NoMoreThanNeeded(SceneCase):
    def test_unused_rooms_and_passes_are_zeros(self):
        self.assertGreaterEqual(len(scenes()), 3)
        for scene in scenes():
            with self.subTest(scene.name):
                done = corsac("run", scene, "--headless", "--quiet", "--steps", 20, "--metrics", "-")
                self.assertIn(done.code, (0, 3), str(done))  # 3: a scene's own checks need more steps
                m = json.loads(done.out)
                self.check(m, scene.read_text())
                self.assertIsNone(m["device"])

    def check(self, m, text):
        for room, words in WORDS.items():
            if re.search(words, text):
                continue
            self.assertIn(m["memory"][room], (0, None), room)
            for stage, figures in m["stages"].items():
                if stage == STAGE.get(room) or stage.startswith(f"{room}."):
                    self.assertIn(figures["total"], (0, None), stage)
            for count in COUNTS[room].split():
                self.assertIn(m["counts"][count], (0, None), count)

    def test_the_receipt_of_a_run_without_pictures_shows_no_pass(self):
        for scene in scenes():
            done = corsac("run", scene, "--headless", "--quiet", "--steps", 2, "--receipt")
            self.assertIn("frames 0, passes 0, shader variants 0", done.out, str(done))

    def test_every_room_that_is_not_used_somewhere_is_used_elsewhere(self):
        texts = [p.read_text() for p in scenes()]
        for room in ("phys", "gfx", "anim"):
            used = [bool(re.search(WORDS[room], t)) for t in texts]
            self.assertIn(True, used, room)


if __name__ == "__main__":
    unittest.main()
