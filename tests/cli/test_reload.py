"""--watch: changed scripts run anew in the same world; a broken file leaves the old code in place."""

import unittest

from support import SceneCase

# The scene rewrites its own module from inside the run, so that the moment is a step of the run.
MAIN = """
local speed = require("speed")
local state = corsac.persist("state", { ticks = 0, reloads = 0 })
local body
function corsac.load() body = corsac.phys.newBody{ shape = "sphere" } end
corsac.on("tick", function() state.ticks = state.ticks + 1 end)
function corsac.fixed()
    corsac.emit("tick")
    corsac.metrics.set("speed", speed)
    corsac.metrics.set("ticks", state.ticks)
    corsac.metrics.set("reloads", state.reloads)
    corsac.metrics.set("bodies", corsac.phys.getBodyCount())
    if corsac.getStep() == 20 then corsac.log("step twenty") end
end
function corsac.update() local t = os.clock() while os.clock() < t + 0.004 do end end
function corsac.reload(kept) kept.state.reloads = kept.state.reloads + 1 end
"""


class Reload(SceneCase):
    def play(self, new_text, steps=150):
        import json
        import os
        import subprocess
        import threading
        import time
        from support import CORSAC, ROOT
        main, speed = self.write("main.lua", MAIN), self.write("speed.lua", "return 1")
        metrics = self.dir / "metrics.json"
        run = subprocess.Popen(
            [CORSAC, "run", str(main), "--headless", "--watch", "--keep-going", "--steps", str(steps),
             "--metrics", str(metrics)], cwd=ROOT, stderr=subprocess.PIPE, text=True)
        for line in run.stderr:
            if "step twenty" in line:
                os.utime(speed, ns=(0, 0))
                speed.write_text(new_text, encoding="utf-8")
                break
        rest = run.stderr.read()
        run.wait(60)
        run.stderr.close()
        return json.loads(metrics.read_text(encoding="utf-8"))["user"], rest

    def test_new_code_runs_in_the_same_world(self):
        user, text = self.play("return 7")
        self.assertEqual((user["speed"], user["reloads"], user["bodies"]), (7, 1, 1), text)
        self.assertEqual(user["ticks"], 150, "one listener, never two")
        self.assertIn("speed.lua changed: loaded again", text)

    def test_a_broken_file_leaves_the_old_code(self):
        user, text = self.play("return 7 +")
        self.assertEqual((user["speed"], user["reloads"], user["ticks"]), (1, 0, 150), text)
        self.assertIn("speed.lua:1:", text)
        self.assertIn("the old code stays", text)


if __name__ == "__main__":
    unittest.main()
