"""Stability maps: where in a plane of two parameters a method fails, and how.

[map] x, y = {name, lo, hi, log, integer, label}; grid = cells a side of the first grid (default 6);
depth = times that cells on the border are halved (default 3);
criteria = [{name, key, op, value}]: the first that a run fulfils is its verdict, else "stable"; a run
that breaks down or lacks the key has the verdict of the first criterion. Names are explodes, falls,
tunnels, sinks, drifts, gains energy, loses energy, oscillates, shadows itself, leaks, fights,
mostly over, overflows, leaks much, pops, overlaps, does not arrive, promised, not climbed.
"""

import math

from judge import OPS, number


def position(axis, t):
    lo, hi = axis["lo"], axis["hi"]
    value = lo * (hi / lo) ** t if axis.get("log") else lo + (hi - lo) * t
    return round(value) if axis.get("integer") else float(f"{value:.6g}")


def verdict(exp, figures):
    criteria = exp.map["criteria"]
    if "broken" in figures:
        return criteria[0]["name"]
    for rule in criteria:
        value = figures.get(rule["key"])
        if value is None or (isinstance(value, float) and not math.isfinite(value)):
            return criteria[0]["name"]
        if number(value) and OPS[rule["op"]](value, rule["value"]):
            return rule["name"]
    return "stable"


def mixed(corner, found):
    return len({found[c] for c in corner}) > 1


def corners(cell):
    i, j, size = cell
    return ((i, j), (i + size, j), (i, j + size), (i + size, j + size))


def sample(exp, label, evaluate):
    """All samples of one method: a coarse grid, then cells on the border halved `depth` times."""
    grid, depth = exp.map.get("grid", 6), exp.map.get("depth", 3)
    unit = 2 ** depth
    total = grid * unit
    found = {}

    def ask(points):
        fresh = sorted(p for p in set(points) if p not in found)
        values = [(position(exp.map["x"], i / total), position(exp.map["y"], j / total)) for i, j in fresh]
        for p, figures in zip(fresh, evaluate(label, values)):
            found[p] = verdict(exp, figures)

    cells = [(i * unit, j * unit, unit) for i in range(grid) for j in range(grid)]
    ask(p for cell in cells for p in corners(cell))
    for _ in range(depth):
        border = [c for c in cells if mixed(corners(c), found)]
        cells = [(i + di * size // 2, j + dj * size // 2, size // 2)
                 for i, j, size in border for di in (0, 1) for dj in (0, 1)]
        ask(p for cell in cells for p in corners(cell))
    return [{"x": position(exp.map["x"], i / total), "y": position(exp.map["y"], j / total), "verdict": v}
            for (i, j), v in sorted(found.items())]


def build(exp, run):
    """The map of an experiment; `run(params list)` gives the figures of each."""
    def evaluate(label, values):
        x, y = exp.map["x"]["name"], exp.map["y"]["name"]
        return run([{**exp.params(label, {x: vx, y: vy}, exp.seeds[0])} for vx, vy in values])

    result = {"experiment": exp.name, "digest": exp.digest, "title": exp.title, "fixed": exp.fixed,
              "x": exp.map["x"], "y": exp.map["y"], "criteria": exp.map["criteria"], "methods": {}}
    for label, method in exp.methods.items():
        samples = sample(exp, label, evaluate)
        stable = sum(s["verdict"] == "stable" for s in samples)
        result["methods"][label] = {"params": method, "samples": samples, "stable": stable}
    return result
