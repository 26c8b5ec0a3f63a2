#!/usr/bin/env python3
"""Corsac beside other physics engines: the same scenes, one run, two tables.

    tools/peers/bench.py [--quick | --front] [--engines corsac,box3d,bullet,ode] [--out DIR] [--publish]

Scenes and measures are scenes.c's (S1 to S12); overlap, energy and gaps are computed from poses alone.
With one thread the clock is process CPU time. Corsac runs with AVX2 forced; its default set is a bonus
line. Ratios are against Box3D of the same run, or against the slowest peer where Box3D is missing. Then
every engine at every setting of its own, time against error, as a chart (front.py).
"""

import argparse
import json
import os
import shutil
import statistics
import subprocess
import sys
from pathlib import Path

import front

ROOT = Path(__file__).resolve().parents[2]
HERE = ROOT / "tools/peers"
BUILD = ROOT / "build/peers"

SPEED = [  # label, words, key, Corsac's goal as a ratio to Box3D
    ("S1 2,500 balls settled", "s1 --n=2500 --steps=480", "ms_settled", 0.5),
    ("S1 2,500 balls falling", "s1 --n=2500 --steps=480", "ms_fall", 0.6),
    ("S1 10,000 settled", "s1 --n=10000 --steps=300", "ms_settled", 0.5),
    ("S1 10,000 falling", "s1 --n=10000 --steps=300", "ms_fall", 0.6),
    ("S2 pyramid 40", "s2 --n=40 --steps=200", "ms_settled", 0.6),
    ("S2 pyramid 100", "s2 --n=100 --steps=120", "ms_settled", 0.7),
    ("S6 1,000 hulls settled", "s6 --n=1000 --steps=400", "ms_settled", 0.6),
    ("S6 1,000 hulls falling", "s6 --n=1000 --steps=400", "ms_fall", 0.55),
    ("S7 chain 50", "s7 --n=50 --arg=10", "ms_med", 0.5),
    ("S8 joint grid 50x50", "s8 --n=50 --steps=150", "ms_med", 0.4),
    ("S9 cloth 40x40", "s9 --n=40 --steps=150", "ms_med", 0.4),
]
ERROR = [  # label, words, key, scale, unit, Corsac's bound in that unit
    ("S1 2,500 at rest, worst overlap", "s1 --n=2500 --steps=480", "pen_max_end", 1e3, "mm", 10),
    ("S1 1,000 at rest, mean overlap", "s1 --n=1000 --steps=480", "pen_mean_end", 1e3, "mm", 0.5),
    ("S2 pyramid 40, sag", "s2 --n=40 --steps=200", "top_sag", 1e3, "mm", 20),
    ("S3 stack of 40, 60 s: sag", "s3 --n=40", "top_sag", 1e3, "mm", 40),
    ("S3 40 with 1 cm offsets: drift", "s3 --n=40 --arg=0.01", "drift_max", 1e3, "mm", 10),
    ("S4 one under 1:100, sag", "s4 --n=1 --arg=100", "top_sag", 1e3, "mm", 3),
    ("S4 one under 1:1000", "s4 --n=1 --arg=1000", "top_sag", 1e3, "mm", 25),
    ("S4 five under 1:1000", "s4 --n=5 --arg=1000", "top_sag", 1e3, "mm", 100),
    ("S6 500 hulls at rest, worst overlap", "s6 --n=500 --steps=480", "pen_max_end", 1e3, "mm", 3),
    ("S7 end mass 1:1, worst gap", "s7 --n=50 --arg=1", "joint_err_max", 1e3, "mm", 5),
    ("S7 end mass 1:100", "s7 --n=50 --arg=100", "joint_err_max", 1e3, "mm", 20),
    ("S7 end mass 1:1000", "s7 --n=50 --arg=1000", "joint_err_max", 1e3, "mm", 50),
    ("S8 joint grid, worst gap", "s8 --n=50 --steps=150", "joint_err_max", 1e3, "mm", 2),
    ("S9 cloth, mean rod error", "s9 --n=40 --steps=300", "rod_err_mean_worst", 1e2, "%", 1),
    ("S10b pendulum height after 60 s", "s10b", "height_last4s", 1e2, "%", None),
    ("S10a spin energy in 60 s", "s10a", "energy_drift_max", 1e2, "%", 0.1),
    ("S10c thrown ball in 5 s", "s10c", "pos_err_max", 1e3, "mm", 1),
    ("S11 creep at 26 degrees", "s11 --arg=26", "creep_mm_s", 1, "mm/s", 0.01),
    ("S11 slide at 27 degrees, error", "s11 --arg=27", "rel_err", 1e2, "%", 0.2),
    ("S12 e = 0.5: bounce height", "s12 --arg=0.5", "bounce1", 1, "of 0.25", None),
    ("S12 e = 0.5: dip below the floor", "s12 --arg=0.5", "lowest", -1e3, "mm", 5),
    ("S5 20 mm wall at 500 m/s, through", "s5 --n=20 --arg=500", "through", 1e2, "%", 0),
    ("S5d 20 mm free plate at 500 m/s", "s5d --n=20 --arg=500 --bullet", "through", 1e2, "%", 0),
    ("S1 1,000 balls all asleep after", "s1 --n=1000 --sleep --steps=3600", "asleep_at_step", 1 / 60, "s", 10),
]
QUICK = ("S1 10,000", "S2 pyramid 100", "S6 1,000", "S8")


def have(library):
    return subprocess.run(["pkg-config", "--exists", library], check=False).returncode == 0


def compile_c(name, words):
    subprocess.run([*words, "-o", str(BUILD / name)], check=True, cwd=ROOT)
    return BUILD / name


def build(name):
    """The program of one engine, or None with the reason printed."""
    scenes = str(HERE / "scenes.c")
    gnu = ["gcc", "-std=gnu17", "-O2", "-march=native", "-I", str(HERE)]
    if name == "corsac":
        return compile_c(name, [*gnu, "-I", "engine", str(HERE / "ad_corsac.c"), scenes, "build/libcorsac.a",
                                "-lm", "-lpthread"])
    if name == "ode":
        if shutil.which("gcc") and (Path("/usr/include/ode/ode.h").exists() or have("ode")):
            return compile_c(name, [*gnu, str(HERE / "ad_ode.c"), scenes, "-lode", "-lm"])
        return print("peers: ode skipped, package libode-dev is not installed")
    if name == "bullet":
        if not shutil.which("g++") or not have("bullet"):
            return print("peers: bullet skipped, packages g++ and libbullet-dev are not installed")
        flags = subprocess.run(["pkg-config", "--cflags", "bullet"], capture_output=True, text=True,
                               check=True).stdout.split()
        obj = str(BUILD / "scenes.o")
        subprocess.run([*gnu, "-c", scenes, "-o", obj], check=True)
        return compile_c(name, ["g++", "-std=c++17", "-O2", "-march=native", "-I", str(HERE), *flags,
                                str(HERE / "ad_bullet.cpp"), obj, "-lBulletDynamics", "-lBulletCollision",
                                "-lLinearMath", "-lm"])
    if not shutil.which("cargo"):
        return print("peers: box3d skipped, there is no Rust toolchain (cargo)")
    env = {**os.environ, "CARGO_TARGET_DIR": str(BUILD / "rs"), "RUSTFLAGS": "-C target-cpu=native",
           "CFLAGS": "-O3 -march=native"}
    done = subprocess.run(["cargo", "build", "--release", "-q"], cwd=HERE / "box3d", env=env, check=False)
    if done.returncode != 0:
        return print("peers: box3d skipped, its crate did not build")
    return BUILD / "rs/release/peer_box3d"


class Runs:
    """Figures of (engine, scene words), each run `repeats` times and kept."""

    def __init__(self, programs, repeats):
        self.programs, self.repeats, self.known = programs, repeats, {}

    def one(self, engine, words):
        env = {**os.environ, "CORSAC_SIMD": "auto" if engine == "corsac auto" else "avx2"}
        done = subprocess.run([str(self.programs[engine]), *words.split()], capture_output=True, text=True,
                              env=env, timeout=600, check=False)
        try:
            return {**json.loads(done.stdout), "lost": "no longer finite" in done.stderr}
        except json.JSONDecodeError:
            return {}

    def figure(self, engine, words, key, repeats=1):
        runs = self.known.setdefault((engine, words), [])
        while len(runs) < repeats:
            runs.append(self.one(engine, words))
        values = [r[key] for r in runs if isinstance(r.get(key), (int, float))]
        fell = any(r.get("fell_at_s", -1) >= 0 or r.get("fell") for r in runs)
        return ("fell" if fell else statistics.median(values)) if values else None


def shown(value, form="{:.3g}"):
    return "–" if value is None else value if isinstance(value, str) else form.format(value)


def speed_table(runs, engines, rows):
    base = "box3d" if "box3d" in engines else engines[-1]
    print(f"\nms per step, one thread; in brackets the ratio to {base}\n")
    print(f"{'scene':26}" + "".join(f"{e:>20}" for e in engines) + f"{'goal':>8}")
    out = []
    for label, words, key, goal in rows:
        for repeat in range(runs.repeats):  # in turn: a slow minute touches all engines alike
            for engine in engines:
                runs.figure(engine, words, key, repeat + 1)
        values = {e: runs.figure(e, words, key) for e in engines}
        line = f"{label:26}"
        for engine in engines:
            v, b = values[engine], values[base]
            ratio = f" ({v / b:.2f})" if isinstance(v, float) and isinstance(b, float) and b else ""
            line += f"{shown(v) + ratio:>20}"
        print(line + f"{shown(goal):>8}", flush=True)
        out.append({"scene": label, "goal": goal, "ms": values})
    return out


def error_table(runs, engines, rows):
    print(f"\n{'error':38}" + "".join(f"{e:>12}" for e in engines) + f"{'bound':>14}")
    out = []
    for label, words, key, scale, unit, bound in rows:
        values = {}
        for engine in engines:
            v = runs.figure(engine, words, key)
            values[engine] = v * scale if isinstance(v, (int, float)) and not isinstance(v, bool) else v
        print(f"{label:38}" + "".join(f"{shown(values[e]):>12}" for e in engines)
              + f"{(shown(bound) + ' ' if bound is not None else '') + unit:>14}", flush=True)
        out.append({"row": label, "unit": unit, "bound": bound, "values": values})
    return out


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="leave out the largest scenes, one repeat")
    parser.add_argument("--front", action="store_true", help="only time against error")
    parser.add_argument("--publish", action="store_true", help="put the chart into docs/charts")
    parser.add_argument("--engines", default="corsac,box3d,bullet,ode")
    parser.add_argument("--out", default=str(ROOT / "out"), type=Path)
    args = parser.parse_args()
    BUILD.mkdir(parents=True, exist_ok=True)
    programs = {}
    for name in args.engines.split(","):
        program = build(name)
        if program:
            programs[name] = program
    if "corsac" in programs:
        programs["corsac auto"] = programs["corsac"]
    engines = list(programs)
    rows = [r for r in SPEED if not (args.quick and r[0].startswith(QUICK))]
    runs = Runs(programs, 1 if args.quick else 3)
    args.out.mkdir(parents=True, exist_ok=True)
    once = [e for e in engines if e != "corsac auto"]
    result = {}
    if not args.front:
        result = {"speed": speed_table(runs, engines, rows), "errors": error_table(runs, once, ERROR)}
    if args.front or not args.quick:
        chart = (ROOT / "docs/charts" if args.publish else args.out) / "peers_front.svg"
        result["front"] = front.run(runs, once, chart)
    name = "peers_front.json" if args.front else "peers.json"
    (args.out / name).write_text(json.dumps(result, indent=1) + "\n")
    print(f"\nwritten to {args.out / name}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
