"""Experiments: what is run, swept, measured and expected. One TOML file each in scripts/lab/.

title, question       texts of the report
kernel | scene        a lab kernel (`corsac lab-run --list`) or a Lua scene run headless
quick                 true: part of `LAB=quick`; docs: true: its chart is copied to docs/charts
[fixed]               parameters of every case (scenes: `steps`, and `--set` names)
[methods.LABEL]       parameters of a method; `baseline = true`, `peer = true` mark it on charts;
                      `tune = false` keeps it from the fronts that `corsac tune` searches,
                      `rename = {a = "b"}` gives the method the swept parameter a under the name b
[sweep]               NAME = [values]: the full grid; [quick_sweep] replaces lists for LAB=quick
[error], [cost]       key (of the kernel's or metrics' figures), unit, label; a cost key "cpu_ms_per_step"
                      is the process CPU time of the run divided by its steps, "cpu_ms_per_s" by the
                      simulated seconds
seeds, repeats        of accuracy and of timing
[chart]               panel = sweep name (one panel each), line = "method" (default), x, y
[[expect]]            assertions, see judge.py
[map]                 a stability map, see maps.py
reference             name in references.py: adds figures by a known answer or another judge
stated                [{x, y, text}]: figures that others state, drawn as stars on a line chart
[binaries]            NAME = path of another build; a method takes it by `binary = NAME`
"""

import hashlib
import itertools
import json
import tomllib
from dataclasses import dataclass, field
from pathlib import Path

KNOWN = {"title", "question", "kernel", "scene", "quick", "docs", "fixed", "methods", "sweep", "quick_sweep",
         "error", "cost", "seeds", "repeats", "chart", "expect", "map", "binaries", "reference", "stated"}


class BadExperiment(Exception):
    """An experiment file that does not say what it must."""


@dataclass
class Experiment:
    name: str
    title: str
    question: str
    kernel: str | None
    scene: str | None
    fixed: dict
    methods: dict
    sweep: dict
    error: dict
    cost: dict
    seeds: list
    repeats: int
    chart: dict
    expect: list
    map: dict
    quick: bool
    docs: bool
    digest: str
    binaries: dict = field(default_factory=dict)
    reference: str | None = None
    stated: list = field(default_factory=list)
    shortened: bool = False  # has a [quick_sweep]

    def points(self):
        """(method label, sweep values) for every row of the result."""
        names = list(self.sweep)
        for label in self.methods:
            for values in itertools.product(*self.sweep.values()):
                yield label, dict(zip(names, values))

    def params(self, label, point, seed):
        """All parameters of one case."""
        mine = self.methods[label]
        method = {k: v for k, v in mine.items() if k not in ("baseline", "peer", "binary", "rename", "tune")}
        names = mine.get("rename", {})
        return {**self.fixed, **method, **{names.get(k, k): v for k, v in point.items()}, "seed": seed}


def digest_of(raw):
    """What a full run depends on: the file as read, without what only LAB=quick looks at."""
    full = {k: v for k, v in raw.items() if k not in ("quick", "quick_sweep")}
    return hashlib.sha256(json.dumps(full).encode()).hexdigest()[:16]


def load(path, quick=False):
    """Reads and checks one file; BadExperiment names file and field."""
    text = Path(path).read_bytes()
    name = Path(path).stem
    try:
        raw = tomllib.loads(text.decode())
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as err:
        raise BadExperiment(f"{path}: {err}") from err
    for key in raw:
        if key not in KNOWN:
            raise BadExperiment(f"{path}: unknown field '{key}'; known: {', '.join(sorted(KNOWN))}")
    if ("kernel" in raw) == ("scene" in raw):
        raise BadExperiment(f"{path}: exactly one of 'kernel' and 'scene' expected")
    for key in ("title", "methods"):
        if key not in raw:
            raise BadExperiment(f"{path}: field '{key}' is missing")
    for key in ("error", "cost"):
        if key in raw and "key" not in raw[key]:
            raise BadExperiment(f"{path}: [{key}] needs 'key', the name of the figure")
    sweep = dict(raw.get("sweep", {}))
    if quick:
        sweep.update(raw.get("quick_sweep", {}))
    return Experiment(
        name=name, title=raw["title"], question=raw.get("question", ""), kernel=raw.get("kernel"),
        scene=raw.get("scene"), fixed=raw.get("fixed", {}), methods=raw["methods"], sweep=sweep,
        error=raw.get("error", {}), cost=raw.get("cost", {}), seeds=raw.get("seeds", [1]),
        repeats=raw.get("repeats", 3), chart=raw.get("chart", {}), expect=raw.get("expect", []),
        map=raw.get("map", {}), quick=raw.get("quick", False), docs=raw.get("docs", False),
        digest=digest_of(raw), binaries=raw.get("binaries", {}),
        reference=raw.get("reference"), stated=raw.get("stated", []),
        shortened="quick_sweep" in raw)
