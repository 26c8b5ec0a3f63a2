"""Runs cases: accuracy in parallel (processes of this machine or Dask workers), timing one at a time.

Every finished case is kept in OUT/NAME/cases.jsonl under a digest of its command and of the program,
so that an interrupted run goes on where it stopped.
"""

import hashlib
import json
import os
import re
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor, as_completed
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def command_of(corsac, exp, params, timed):
    """The words of one run."""
    if exp.kernel:
        case = {k: v for k, v in params.items() if k != "seed"}
        case["seed"] = params["seed"]
        if timed:
            case["timed"] = 1
        return [corsac, "lab-run", exp.kernel, "--case", json.dumps(case, sort_keys=True)]
    length = ["--seconds", str(params["seconds"])] if "seconds" in params else ["--steps", str(params.get("steps", 600))]
    words = [corsac, "run", str(ROOT / exp.scene), "--headless", "--quiet", "--metrics", "-",
             "--threads", str(params.get("threads", 1)), "--simd", params.get("simd", "auto"),
             "--seed", str(params["seed"]), *length]
    for key in ("substeps", "dt"):
        if key in params:
            words += [f"--{key}", str(params[key])]
    for key, value in params.items():
        if key not in ("threads", "simd", "seed", "steps", "seconds", "substeps", "dt"):
            words += ["--set", f"{key}={value}"]
    return words + (["--set", "metrics.accuracy=off"] if timed else [])


def flatten(tree, prefix=""):
    """{"a": {"b": 1}} -> {"a.b": 1}; lists are left out."""
    flat = {}
    for key, value in tree.items():
        if isinstance(value, dict):
            flat.update(flatten(value, f"{prefix}{key}."))
        elif isinstance(value, (int, float, str, bool)) or value is None:
            flat[prefix + key] = value
    return flat


def read_figures(text):
    """The figures of a program's JSON. A build with -ffast-math cannot tell what is no number and
    writes nan where null belongs: `json_mended` counts those."""
    mended, count = re.subn(r"(?<=[\s:,])-?(nan|inf)(?=[\s,}])", "null", text)
    return {**flatten(json.loads(mended)), **({"json_mended": count} if count else {})}


def execute(words, timeout=600):
    """One process: its JSON figures, with the CPU time it took; {"broken": why} when it failed."""
    with subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        try:
            out, err = process.communicate(timeout=timeout)
        except subprocess.TimeoutExpired:
            process.kill()
            return {"broken": f"no end after {timeout} s: {' '.join(words)}"}
    if process.returncode != 0:
        last = (err.strip().splitlines() or ["no message"])[-1]
        return {"broken": f"exit {process.returncode}: {last} ({' '.join(words)})"}
    try:
        return read_figures(out)
    except json.JSONDecodeError:
        return {"broken": f"printed no JSON: {' '.join(words)}"}


def execute_timed(words):
    """As execute, alone, with the CPU time of the process per step and per simulated second."""
    with subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True) as process:
        out = process.stdout.read()
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode != 0:
        return {"broken": f"exit {process.returncode}: {' '.join(words)}"}
    figures = read_figures(out)
    if figures.get("steps"):
        figures["cpu_ms_per_step"] = 1e3 * (usage.ru_utime + usage.ru_stime) / figures["steps"]
        figures["cpu_ms_per_s"] = figures["cpu_ms_per_step"] / figures["dt"]
    return figures


class Progress:
    """A bar on a terminal, silence in a pipe."""

    def __init__(self, title, total):
        self.title, self.total, self.done = title, total, 0
        self.shown = sys.stderr.isatty() and total > 0
        self.start = time.monotonic()
        self.step(0)

    def step(self, n=1):
        self.done += n
        if self.shown:
            width = 30
            full = width * self.done // max(1, self.total)
            left = (time.monotonic() - self.start) / max(1, self.done) * (self.total - self.done)
            print(f"\r{self.title:28.28} [{'#' * full}{'.' * (width - full)}] {self.done}/{self.total}"
                  f" {left:4.0f} s left ", end="\n" if self.done == self.total else "", file=sys.stderr, flush=True)


class Cases:
    """The store of finished cases of one experiment."""

    def __init__(self, folder, scene=None):
        self.path = folder / "cases.jsonl"
        self.scene = scene
        self.digests = {}  # of programs
        self.known = {}
        folder.mkdir(parents=True, exist_ok=True)
        text = self.path.read_text() if self.path.exists() else ""
        for line in text.splitlines():
            try:
                entry = json.loads(line)
                self.known[entry["id"]] = entry["figures"]
            except (json.JSONDecodeError, KeyError):
                continue  # the last line of an interrupted run
        if text and not text.endswith("\n"):
            self.path.write_text(text[:text.rfind("\n") + 1])

    def id_of(self, words, tag):
        program = words[0]
        if program not in self.digests:
            self.digests[program] = program_digest(program, self.scene)
        plain = [w.replace(str(ROOT), "") for w in words[1:]]
        return hashlib.sha256(json.dumps([self.digests[program], tag, plain]).encode()).hexdigest()[:20]

    def get(self, words, tag):
        return self.known.get(self.id_of(words, tag))

    def put(self, words, tag, figures):
        key = self.id_of(words, tag)
        self.known[key] = figures
        if "broken" in figures:
            return  # tried again by the next run
        with self.path.open("a") as file:
            file.write(json.dumps({"id": key, "figures": figures}) + "\n")


def program_digest(corsac, scene=None):
    """Cases of another build or another text of the scene are not reused."""
    digest = hashlib.sha256()
    for path in (corsac, scene):
        if path:
            with open(path, "rb") as file:
                digest.update(file.read())
    return digest.hexdigest()[:16]


def run_all(words_list, cases, jobs, client, title):
    """Figures of every command, in order; only those not known yet are run."""
    missing = [w for w in {tuple(w): w for w in words_list}.values() if cases.get(w, "accuracy") is None]
    progress = Progress(title, len(missing))
    if client is not None:
        from dask.distributed import as_completed as dask_completed
        futures = {client.submit(execute, w, pure=False): w for w in missing}
        for future in dask_completed(list(futures)):
            cases.put(futures[future], "accuracy", future.result())
            progress.step()
    else:
        with ThreadPoolExecutor(max_workers=jobs) as pool:
            futures = {pool.submit(execute, w): w for w in missing}
            for future in as_completed(futures):
                cases.put(futures[future], "accuracy", future.result())
                progress.step()
    return [cases.get(w, "accuracy") for w in words_list]


def time_all(words_list, cases, repeats, title):
    """`repeats` figures of every command, one process at a time, rounds interleaved so that a slow
    minute of the machine touches all alike."""
    progress = Progress(title, len(words_list) * repeats)
    for repeat in range(repeats):
        for words in words_list:
            tag = f"timing {repeat}"
            if cases.get(words, tag) is None:
                cases.put(words, tag, execute_timed(words))
            progress.step()
    return [[cases.get(w, f"timing {r}") for r in range(repeats)] for w in words_list]
