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

    def test_a_changed_sound_starts_the_scene_anew_and_a_broken_one_does_not(self):
        import os
        import subprocess
        import wave
        from support import CORSAC, ROOT

        def beep(path, frames):
            with wave.open(str(path), "wb") as file:
                file.setnchannels(1)
                file.setsampwidth(2)
                file.setframerate(8000)
                file.writeframes(b"\0\0" * frames)
            os.utime(path, ns=(frames, frames))
        sound = self.write("beep.wav", "")
        beep(sound, 800)
        main = self.write("main.lua", """
            function corsac.load()
                corsac.log("frames " .. math.floor(corsac.audio.newSound("beep.wav"):getDuration() * 8000 + 0.5))
            end
            function corsac.fixed() if corsac.getStep() == 20 then corsac.log("step twenty") end end
            function corsac.update() local t = os.clock() while os.clock() < t + 0.004 do end end""")
        run = subprocess.Popen([CORSAC, "run", str(main), "--headless", "--watch", "--steps", "400"],
                               cwd=ROOT, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True)
        heard = []
        for line in run.stderr:
            heard.append(line)
            if "step twenty" in line and "frames 1600" not in "".join(heard):
                beep(sound, 1600)
            elif "step twenty" in line:
                sound.write_bytes(b"RIFF")
        run.wait(60)
        run.stderr.close()
        text = "".join(heard)
        self.assertEqual(run.returncode, 0, text)
        self.assertIn("beep.wav changed: the scene starts anew", text)
        self.assertEqual([line.split()[-1] for line in heard if "frames " in line], ["800", "1600"], text)
        self.assertIn("beep.wav changed and cannot be read: the scene goes on as it is", text)


if __name__ == "__main__":
    unittest.main()
