"""Shipped scenes make no Lua garbage per step in steady state; those that do say where."""

import re
import unittest

from support import ROOT, SceneCase, corsac

# The scene runs under this, with the collector stopped: what the heap grows by in a window is what its
# steps made. Traces are compiled now and then and kept too, so two windows of the eight must have none:
# what every step made would be in all of them.
WATCH = """
require("{name}")
collectgarbage("stop")
local n, last, update = 0, nil, corsac.update
function corsac.update(dt)
    n = n + 1
    if n % {window} == 0 then
        local now = collectgarbage("count")
        if last then corsac.warn(string.format("garbage %.1f", (now - last) * 1024 / {window})) end
        last = collectgarbage("count")
    end
    if update then update(dt) end
end
"""
WINDOW, STEPS = 50, 451
BOUND = 16  # bytes a step: where a step leaves compiled code, numbers are boxed


class Garbage(SceneCase):
    def test_shipped_scenes_make_none(self):
        scenes = sorted((ROOT / "scripts/scenes").rglob("*.lua"))
        self.assertGreater(len(scenes), 30)
        for scene in scenes:
            text = scene.read_text(encoding="utf-8")
            if "corsac.load" not in text or "-- garbage:" in text:
                continue
            with self.subTest(scene=str(scene.relative_to(ROOT))):
                for file in scene.parent.glob("*.lua"):
                    self.write(file.name, file.read_text(encoding="utf-8"))
                watched = self.write("watched_.lua", WATCH.format(name=scene.stem, window=WINDOW))
                done = corsac("run", watched, "--headless", "--quiet", "--keep-going", "--steps", STEPS)
                found = [float(text) for text in re.findall(r"garbage (-?[\d.]+)", done.err)]
                self.assertGreater(len(found), 6, str(done))
                self.assertLessEqual(sorted(found)[1], BOUND, found)


if __name__ == "__main__":
    unittest.main()
