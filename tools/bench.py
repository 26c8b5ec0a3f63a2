#!/usr/bin/env python3
"""Milliseconds per step of the falling spheres, for several numbers of spheres -> out/bench.json.

Each figure is the median of several runs of the real program, headless and without accuracy
sampling. p50 and p95 are wall time of one step; `cpu` is process CPU time (user and system, set-up
included) over the number of steps, which other work on the machine disturbs least. Kernels are
forced to AVX2, so that machines with and without AVX-512 compare.
"""

import argparse
import json
import os
import platform
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SCENE = "scripts/scenes/spheres.lua"


def measure(options, n):
    """Metrics of one run, with the CPU seconds that its process took as cpu_s."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "metrics.json"
        command = [options.corsac, "run", SCENE, "--headless", "--quiet", "--steps", options.steps,
                   "--threads", options.threads, "--simd", options.simd, "--set", f"n={n}",
                   "--set", "metrics.accuracy=off", "--metrics", path]
        process = subprocess.Popen([str(word) for word in command], cwd=ROOT, stdout=subprocess.DEVNULL)
        _, status, usage = os.wait4(process.pid, 0)
        code = process.returncode = os.waitstatus_to_exitcode(status)
        if code != 0:
            sys.exit(f"bench: exit {code} from {' '.join(map(str, command))}")
        return {**json.loads(path.read_text()), "cpu_s": usage.ru_utime + usage.ru_stime}


def row_of(options, n):
    runs = [measure(options, n) for _ in range(options.runs)]
    hashes = {run["hash"] for run in runs}
    if len(hashes) != 1:
        sys.exit(f"bench: n={n} gave {len(hashes)} different hashes")
    median = statistics.median
    return {
        "n": n,
        "p50_ms": median(run["step_ms"]["p50"] for run in runs),
        "p95_ms": median(run["step_ms"]["p95"] for run in runs),
        "cpu_ms": median(1000 * run["cpu_s"] / run["steps"] for run in runs),
        "peak_rss_kb": median(run["memory"]["peak_rss_kb"] for run in runs),
        "contacts": runs[0]["counts"]["contacts"],
        "hash": runs[0]["hash"],
    }


def processor():
    for line in Path("/proc/cpuinfo").read_text().splitlines():
        if line.startswith("model name"):
            return line.split(":", 1)[1].strip()
    return platform.machine()


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--corsac", default=ROOT / "build/corsac")
    parser.add_argument("--n", type=int, nargs="+", default=[500, 1000, 2500, 4500, 10000])
    parser.add_argument("--steps", type=int, default=600)
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--simd", default="avx2")
    parser.add_argument("--out", type=Path, default=ROOT / "out/bench.json")
    options = parser.parse_args()
    options.corsac = Path(options.corsac).resolve()

    print(f"{SCENE}: {options.steps} steps, median of {options.runs}, {options.threads} thread(s), {options.simd}")
    print(f"{'spheres':>8} {'p50 ms':>9} {'p95 ms':>9} {'cpu ms':>9} {'contacts':>9} {'MB':>7}")
    rows = []
    for n in options.n:
        row = row_of(options, n)
        rows.append(row)
        print(f"{n:8} {row['p50_ms']:9.3f} {row['p95_ms']:9.3f} {row['cpu_ms']:9.3f}"
              f" {row['contacts']:9} {row['peak_rss_kb'] / 1000:7.1f}", flush=True)
    options.out.parent.mkdir(parents=True, exist_ok=True)
    options.out.write_text(json.dumps({
        "scene": SCENE, "steps": options.steps, "runs": options.runs, "threads": options.threads,
        "simd": options.simd, "cpu": processor(), "rows": rows}, indent=1) + "\n")
    print(f"Wrote {options.out}")


if __name__ == "__main__":
    main()
