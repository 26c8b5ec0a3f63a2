"""corsac tune SCENE --error 'METRIC<=VALUE' ...: the cheapest settings that keep the bounds.

Candidates are the settings of the stored fronts (assets/stability/fronts.json, made by the lab), tried
from the cheapest on; one that breaks a bound with any of the three seeds is out. Standard library only.
Exit codes: 0 found, 2 bad usage, 3 nothing keeps the bounds.
"""

import argparse
import difflib
import json
import os
import re
import statistics
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

import run as runner  # noqa: E402
from judge import OPS, number  # noqa: E402

ROOT = Path(__file__).resolve().parents[2]
FRONTS = ROOT / "assets/stability/fronts.json"


def arguments(argv):
    parser = argparse.ArgumentParser(prog="corsac tune", description="The cheapest settings that keep the bounds.",
                                     epilog="All other options go to `corsac run` (--steps, --dt, --set n=100, ...).")
    parser.add_argument("scene")
    parser.add_argument("--error", action="append", required=True, metavar="'METRIC<=VALUE'",
                        help="a bound, as 'accuracy.penetration_mean_m<=0.0005'; repeatable, all must hold")
    parser.add_argument("--seeds", default="1,2,3", help="seeds that must all hold (default 1,2,3)")
    parser.add_argument("--out", default="out/tune.json", type=Path, help="settings file (default out/tune.json)")
    parser.add_argument("--corsac", default=os.environ.get("CORSAC", str(ROOT / "build/corsac")), help="the program")
    return parser.parse_known_args(argv)


def read_bound(text):
    found = re.fullmatch(r"\s*([\w.]+)\s*(<=|>=|==|<|>)\s*([-+\w.]+)\s*", text)
    try:
        return found.group(1), found.group(2), float(found.group(3))
    except (AttributeError, ValueError):
        sys.exit(usage(f"--error is '{text}', expected METRIC<=VALUE as accuracy.penetration_max_m<=0.001"))


def usage(text):
    print(f"corsac tune: {text}", file=sys.stderr)
    return 2


def relative_costs(fronts, kind):
    """{settings as JSON: mean cost over the fronts of a kind}, each front measured against its cheapest."""
    costs = {}
    for name, rows in fronts.items():
        if name.startswith(kind) and rows:
            cheapest = min(row["cost"] for row in rows)
            for row in rows:
                costs.setdefault(json.dumps(row["settings"], sort_keys=True), []).append(row["cost"] / cheapest)
    return {key: statistics.mean(found) for key, found in costs.items()}


def candidates(fronts):
    """[(relative cost, settings)], cheapest first: settings of the contact solvers, each with the default
    integrator and with those that the fronts of free motion hold."""
    integrators = {}
    for key, cost in relative_costs(fronts, "world_").items():
        integrators.setdefault(json.loads(key)["phys.integrator"], []).append(cost)
    default = statistics.mean(integrators["exact"]) if "exact" in integrators else 1
    choices = [(1, {})] + [(statistics.mean(cost) / default, {"phys.integrator": name})
                           for name, cost in sorted(integrators.items()) if name != "exact"]
    found = [(cost * factor, {**json.loads(key), **choice})
             for key, cost in relative_costs(fronts, "contact_").items() for factor, choice in choices]
    return sorted(found, key=lambda c: (c[0], len(c[1]), json.dumps(c[1], sort_keys=True)))


def command(args, rest, settings, seed):
    words = [args.corsac, "run", args.scene, "--headless", "--quiet", "--threads", "1", "--metrics", "-",
             "--seed", str(seed), *rest]
    for name, value in settings.items():
        words += ["--set", f"{'phys.substeps' if name == 'substeps' else name}={value}"]
    return words


def breach(figures, bounds):
    """The first bound that does not hold, in words; None when all do."""
    for name, op, value in bounds:
        got = figures.get(name)
        if not number(got) or not OPS[op](got, value):
            return f"{name} = {got if got is None else f'{got:.4g}'}"
    return None


def check_names(figures, bounds):
    for name, _, _ in bounds:
        if name not in figures:
            near = difflib.get_close_matches(name, figures, 1)
            return f"no metric '{name}' in the scene's figures" + (f"; nearest: {near[0]}" if near else "")
        if not number(figures[name]):
            return f"metric '{name}' does not apply to this scene (null)"
    return None


def words_of(settings):
    return " ".join(f"--set {'phys.substeps' if k == 'substeps' else k}={v}" for k, v in settings.items())


def try_settings(args, rest, bounds, seeds, settings):
    """(why it is out or None, worst figure of each bound)."""
    worst = {}
    for seed in seeds:
        figures = runner.execute(command(args, rest, settings, seed))
        if "broken" in figures:
            return figures["broken"], worst
        why = breach(figures, bounds)
        if why:
            return f"{why} with seed {seed}", worst
        for name, op, _ in bounds:
            pick = min if op.startswith(">") else max
            worst[name] = pick(worst.get(name, figures[name]), figures[name])
    return None, worst


def cost_of(args, rest, settings, seed):
    """Median CPU time of a step in ms over three runs, accuracy figures switched off."""
    words = command(args, rest, settings, seed) + ["--set", "metrics.accuracy=off"]
    found = [runner.execute_timed(words).get("cpu_ms_per_step") for _ in range(3)]
    found = [f for f in found if f is not None]
    return statistics.median(found) if found else None


def main(argv=None):
    args, rest = arguments(argv)
    bounds = [read_bound(text) for text in args.error]
    seeds = [int(s) for s in args.seeds.split(",")]
    if not FRONTS.exists():
        print(f"corsac tune: {FRONTS.relative_to(ROOT)} is missing; `make lab`, then `make docs`, makes it", file=sys.stderr)
        return 5
    first = runner.execute(command(args, rest, {}, seeds[0]))
    if "broken" in first:
        return usage(first["broken"])
    problem = check_names(first, bounds)
    if problem:
        return usage(problem)
    for _, settings in candidates(json.loads(FRONTS.read_text())):
        why, worst = try_settings(args, rest, bounds, seeds, settings)
        print(f"  {'out ' if why else 'HOLD'}  {words_of(settings):60} {why or ''}")
        if not why:
            return report(args, rest, bounds, seeds, settings, worst)
    print("corsac tune: no setting of the stored fronts keeps these bounds with all seeds; a shorter step (--dt) or a "
          "looser bound may")
    return 3


def report(args, rest, bounds, seeds, settings, worst):
    """The settings that hold against the scene's own, which may hold for less."""
    mine, default = cost_of(args, rest, settings, seeds[0]), cost_of(args, rest, {}, seeds[0])
    if mine and default and default < mine:
        why, own = try_settings(args, rest, bounds, seeds, {})
        print(f"  {'out ' if why else 'HOLD'}  {'the scene as it is':60} {why or ''}")
        settings, worst, mine = (settings, worst, mine) if why else ({}, own, default)
    data = {"scene": args.scene, "bounds": [f"{n}{op}{v:g}" for n, op, v in bounds], "seeds": seeds,
            "settings": {("phys.substeps" if k == "substeps" else k): v for k, v in settings.items()},
            "error": worst, "cost_ms_per_step": mine, "default_ms_per_step": default, "run": words_of(settings)}
    args.out.parent.mkdir(parents=True, exist_ok=True)
    args.out.write_text(json.dumps(data, indent=1) + "\n")
    for name, value in worst.items():
        print(f"{name}: {value:.4g} at worst over {len(seeds)} seeds")
    if not settings:
        print(f"cost: {mine:.4g} ms a step; nothing that keeps the bounds costs less than the scene as it is")
    elif mine and default:
        print(f"cost: {mine:.4g} ms a step, {100 * (1 - mine / default):.0f} % less than the default's {default:.4g}"
              if mine <= default else f"cost: {mine:.4g} ms a step, {mine / default:.2f} times the default's {default:.4g}")
    print(f"{args.out}: corsac run {args.scene} {words_of(settings)}".rstrip())
    return 0


if __name__ == "__main__":
    sys.exit(main())
