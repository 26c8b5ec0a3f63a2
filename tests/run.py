#!/usr/bin/env python3
"""Runs the tests and ends with one line, `N passed, N failed` (`, N skipped` may follow).

    tests/run.py [--long] [--only TEXT] [--jobs N] [--cc gcc]

Quick set: the Unity programs of all rooms (built with MODE=asan), the command line tests
tests/cli/test_*.py and the scene tests tests/scene/*.lua with the release program.
--long runs tests/long, the unit tests with clang, the thread sanitizer on the programs that run jobs,
command line and scene tests under the sanitizers, and compares the hashes of every compiler,
instruction set and thread count. `make test` and `make test-long` build what is needed; a program
that is missing counts as a failure.

Figures that tests print as `accuracy: {"name", "value", "bound", "unit"}` (tests/support/accuracy.h)
are left in out/accuracy.json; --only and --long renew those of the tests that they run.

A scene test is a Lua scene with `corsac.expect`; it must exit with 0. Comment lines at its head may
hold  `-- args: --steps 120 --set n=5`  (more arguments for `corsac run`),  `-- window`  (run in a
window under xvfb-run instead of headless) and  `-- needs: PATH`  (skipped where PATH, relative to
the repository, is absent).
"""

import argparse
import concurrent.futures
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import threading
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SANITIZERS = {
    "ASAN_OPTIONS": "detect_leaks=1:strict_string_checks=1:detect_stack_use_after_return=1",
    "UBSAN_OPTIONS": "print_stacktrace=1:halt_on_error=1",
    "LSAN_OPTIONS": "print_suppressions=0:suppressions=" + str(ROOT / "tests/lsan.supp"),
    "TSAN_OPTIONS": "halt_on_error=1:second_deadlock_stack=1",
}
PLAYER = {"CORSAC_SAVE": str(ROOT / "build/player")}  # scenes that save do so here
INSTRUCTION_SETS = {"sse2": "sse2", "avx2": "avx2", "avx512": "avx512f"}
figures = {}  # of out/accuracy.json, by name
window_lock = threading.Lock()  # xvfb-run -a picks a display number without locking it


class Outcome:
    """Counts of one test file, what to show when it failed, and why parts were skipped."""

    def __init__(self, passed=0, failed=0, skipped=(), text=""):
        self.passed, self.failed, self.skipped, self.text = passed, failed, list(skipped), text


def product(tag, name):
    """Where the Makefile puts a product of COMPILER-MODE."""
    return ROOT / "build" / ("" if tag == "gcc-release" else tag) / name


def run_program(command, limit, env=None):
    """Exit status (None when it ran out of time) and everything it wrote."""
    try:
        done = subprocess.run(
            [str(word) for word in command], cwd=ROOT, env={**os.environ, **SANITIZERS, **PLAYER, **(env or {})},
            stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=limit)
        text = done.stdout.decode("utf-8", "replace")
        for line in re.findall(r"^accuracy: (\{.*\})$", text, re.M):
            figure = json.loads(line)
            before = figures.get(figure["name"])
            if not before or before["value"] < figure["value"]:  # of one name, the worst
                figures[figure["name"]] = figure
        return done.returncode, text
    except subprocess.TimeoutExpired as late:
        return None, (late.stdout or b"").decode("utf-8", "replace")


def ended(status, limit):
    if status is None:
        return f"stopped after {limit} s"
    return f"killed by signal {-status}" if status < 0 else f"exit {status}"


def unity_test(program, limit):
    if not program.exists():
        return Outcome(failed=1, text=f"{program.relative_to(ROOT)} was not built")
    status, text = run_program([program], limit)
    total = re.search(r"^(\d+) Tests (\d+) Failures (\d+) Ignored", text, re.M)
    if not total:
        return Outcome(failed=1, text=f"{text}\n{ended(status, limit)} before the end of its tests")
    count, failed, ignored = map(int, total.groups())
    skipped = re.findall(r":([^:\n]+:IGNORE.*)$", text, re.M)
    if status != 0 and failed == 0:  # a leak or another report of a sanitizer after the last test
        return Outcome(count - ignored, 1, skipped, f"{text}\n{ended(status, limit)}")
    shown = "\n".join(line for line in text.splitlines() if not line.endswith(":PASS"))
    return Outcome(count - failed - ignored, failed, skipped, shown)


def without_leaks():
    """Environment for runs that load GL drivers: these leak, and are unloaded before the report, so
    that no suppression can name them."""
    return {"ASAN_OPTIONS": SANITIZERS["ASAN_OPTIONS"].replace("detect_leaks=1", "detect_leaks=0")}


def python_test(path, corsac, limit):
    status, text = run_program(
        [sys.executable, "-B", "-m", "unittest", "-v", str(path.relative_to(ROOT))], limit,
        {"CORSAC": str(corsac), "PYTHONPATH": str(ROOT / "tests/cli"), **without_leaks()})
    total = re.search(r"^Ran (\d+) tests? in", text, re.M)
    if not total:
        return Outcome(failed=1, text=f"{text}\n{ended(status, limit)}")
    bad = sum(int(n) for n in re.findall(r"(?:failures|errors|unexpected successes)=(\d+)", text))
    skipped = re.findall(r"^(.* \.\.\. skipped .*)$", text, re.M)
    if status != 0 and bad == 0:
        bad = 1
    return Outcome(max(0, int(total.group(1)) - bad - len(skipped)), bad, skipped, text[text.find("\n===="):])


def head_of(scene):
    """The options in the comment lines that open a scene test."""
    args, window, needs = [], False, []
    for line in scene.read_text(encoding="utf-8").splitlines():
        if not line.startswith("--"):
            break
        word, _, rest = line[2:].strip().partition(" ")
        if word == "args:":
            args += shlex.split(rest)
        elif word == "window":
            window = True
        elif word == "needs:":
            needs.append(rest.strip())
    return args, window, needs


def scene_test(scene, corsac, limit):
    args, window, needs = head_of(scene)
    for need in needs:
        if not (ROOT / need).exists():
            return Outcome(skipped=[f"{need} is absent"])
    command = [corsac, "run", scene.relative_to(ROOT)] + ([] if window else ["--headless"]) + args
    env = without_leaks() if window or "--shot" in args or "--video" in args else {}
    if not window:
        status, text = run_program(command, limit, env)
    elif not shutil.which("xvfb-run"):
        return Outcome(skipped=["xvfb-run is not installed"])
    else:
        with window_lock:
            status, text = run_program(["xvfb-run", "-a"] + command, limit, env)
    if status == 0:
        return Outcome(passed=1)
    return Outcome(failed=1, text=f"{text}\n{ended(status, limit)}: {shlex.join(map(str, command))}")


def processor_has(flag):
    return flag in Path("/proc/cpuinfo").read_text().split()


def hash_test(scene, programs, limit):
    """One hash for every compiler, instruction set and thread count."""
    args, window, needs = head_of(scene)
    if window or any(not (ROOT / need).exists() for need in needs):
        return Outcome(skipped=["needs a window or a file that is absent"])
    outcome, first, lines = Outcome(), None, []
    for program in programs:
        for name, flag in INSTRUCTION_SETS.items():
            if not processor_has(flag):
                outcome.skipped.append(f"this processor has no {name}")
                continue
            for threads in (1, 2, 4):
                command = [program, "run", scene.relative_to(ROOT), "--headless", "--hash", "--quiet",
                           "--simd", name, "--threads", threads] + args
                done = subprocess.run([str(w) for w in command], cwd=ROOT, capture_output=True, text=True,
                                      stdin=subprocess.DEVNULL, timeout=limit)
                value = done.stdout.strip()
                lines.append(f"{value}  exit {done.returncode}  {shlex.join(map(str, command))}{done.stderr}")
                first = first or value
                good = done.returncode == 0 and re.fullmatch("[0-9a-f]{16}", value) and value == first
                outcome.passed += bool(good)
                outcome.failed += not good
    outcome.skipped = sorted(set(outcome.skipped))
    outcome.text = "\n".join(lines)
    return outcome


def quick_set(cc):
    for source in sorted(ROOT.glob("tests/*/test_*.c")):
        name = source.relative_to(ROOT).with_suffix("")
        yield str(name), lambda n=name: unity_test(product(f"{cc}-asan", n), 300)
    corsac = product(f"{cc}-release", "corsac")
    for path in sorted(ROOT.glob("tests/cli/test_*.py")):
        yield str(path.relative_to(ROOT)), lambda p=path: python_test(p, corsac, 600)
    for scene in sorted(ROOT.glob("tests/scene/*.lua")):
        yield str(scene.relative_to(ROOT)), lambda s=scene: scene_test(s, corsac, 300)


def uses_jobs(source):
    return "core/jobs.h" in source.read_text(encoding="utf-8")


def long_set():
    units = sorted(ROOT.glob("tests/*/test_*.c"))
    for source in sorted(ROOT.glob("tests/long/*/test_*.c")):
        name = source.relative_to(ROOT).with_suffix("")
        yield str(name), lambda n=name: unity_test(product("gcc-release", n), 1500)
    for tag, chosen in (("clang-asan", units), ("gcc-tsan", filter(uses_jobs, units))):
        for source in chosen:
            name = source.relative_to(ROOT).with_suffix("")
            yield f"{name} ({tag})", lambda n=name, t=tag: unity_test(product(t, n), 900)
    for path in sorted(ROOT.glob("tests/cli/test_*.py")):
        for tag in ("clang-release", "gcc-asan"):
            yield (f"{path.relative_to(ROOT)} ({tag})",
                   lambda p=path, t=tag: python_test(p, product(t, "corsac"), 1500))
    for path in sorted(ROOT.glob("tests/long/cli/test_*.py")):
        yield str(path.relative_to(ROOT)), lambda p=path: python_test(p, product("gcc-release", "corsac"), 1500)
    for scene in sorted(ROOT.glob("tests/scene/*.lua")):
        for tag in ("gcc-asan", "gcc-tsan"):
            yield (f"{scene.relative_to(ROOT)} ({tag})",
                   lambda s=scene, t=tag: scene_test(s, product(t, "corsac"), 900))
        programs = [product(tag, "corsac") for tag in ("gcc-release", "clang-release")]
        yield f"{scene.relative_to(ROOT)} (hashes)", lambda s=scene, p=programs: hash_test(s, p, 300)


def guarded(test):
    start = time.monotonic()
    try:
        outcome = test()
    except Exception as error:  # a broken test is a failed test, not the end of the run
        outcome = Outcome(failed=1, text=f"{type(error).__name__}: {error}")
    return outcome, time.monotonic() - start


def report(name, outcome, seconds):
    word = "FAIL" if outcome.failed else "ok" if outcome.passed else "skip"
    print(f"{word:4}  {name}  {outcome.passed} passed"
          + (f", {outcome.failed} failed" if outcome.failed else "") + f"  {seconds:.1f} s")
    for reason in outcome.skipped:
        print(f"      skipped: {reason}")
    if outcome.failed:
        for line in outcome.text.strip().splitlines()[-60:]:
            print("    | " + line)
    sys.stdout.flush()


def write_figures(whole):
    path = ROOT / "out/accuracy.json"
    before = {} if whole or not path.exists() else {f["name"]: f for f in json.loads(path.read_text())}
    path.parent.mkdir(exist_ok=True)
    lines = [json.dumps(figure) for _, figure in sorted({**before, **figures}.items())]
    path.write_text("[\n" + ",\n".join(lines) + "\n]\n", encoding="utf-8")


def main():
    parser = argparse.ArgumentParser(description="Runs the tests; see the head of this file.")
    parser.add_argument("--long", action="store_true", help="the long set instead of the quick one")
    parser.add_argument("--only", default="", help="only tests whose name contains this text")
    parser.add_argument("--jobs", type=int, default=len(os.sched_getaffinity(0)))
    parser.add_argument("--cc", default="gcc", help="compiler whose programs the quick set runs")
    options = parser.parse_args()
    tests = [t for t in (long_set() if options.long else quick_set(options.cc)) if options.only in t[0]]
    passed = failed = skipped = 0
    with concurrent.futures.ThreadPoolExecutor(max(1, options.jobs)) as pool:
        waiting = {pool.submit(guarded, test): name for name, test in tests}
        for done in concurrent.futures.as_completed(waiting):
            outcome, seconds = done.result()
            report(waiting[done], outcome, seconds)
            passed += outcome.passed
            failed += outcome.failed
            skipped += len(outcome.skipped)
    if figures:
        write_figures(whole=not (options.only or options.long))
    if not tests:
        print(f"no test's name contains '{options.only}'")
    print(f"{passed} passed, {failed} failed" + (f", {skipped} skipped" if skipped else ""))
    return 1 if failed or not tests else 0


if __name__ == "__main__":
    sys.exit(main())
