"""The lab: speed charted against accuracy, and where methods fail.

  corsac lab [NAME...] [--out DIR] [--jobs N] [--scheduler ADDRESS]

Without names all experiments of scripts/lab/ run; --quick runs the quick set with its short sweeps.
`corsac lab report` draws the figures of the report that the engine grew from, beside what it states.
"""

import argparse
import json
import os
import platform
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

import experiment  # noqa: E402
import judge  # noqa: E402
import references  # noqa: E402
import run as runner  # noqa: E402

ROOT = Path(__file__).resolve().parents[2]


def arguments(argv):
    parser = argparse.ArgumentParser(prog="corsac lab", description="Speed against accuracy, measured and charted.")
    parser.add_argument("names", nargs="*", metavar="NAME", help="experiments (default: all)")
    parser.add_argument("--out", default="out/lab", type=Path, help="results folder (default out/lab)")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="accuracy runs at once")
    parser.add_argument("--scheduler", metavar="ADDRESS", help="Dask scheduler for accuracy runs")
    parser.add_argument("--quick", action="store_true", help="the quick set with short sweeps")
    parser.add_argument("--no-timing", action="store_true", help="accuracy only")
    parser.add_argument("--experiments", default=ROOT / "scripts/lab", type=Path,
                        help="folder of experiment files (default scripts/lab)")
    parser.add_argument("--list", action="store_true", help="list the experiments")
    parser.add_argument("--corsac", default=os.environ.get("CORSAC", str(ROOT / "build/corsac")), help="the program")
    return parser.parse_args(argv)


def machine_facts():
    model = next((line.split(":")[1].strip() for line in Path("/proc/cpuinfo").read_text().splitlines()
                  if line.startswith("model name")), platform.processor())
    return {"machine": model, "processors": os.cpu_count(), "system": platform.platform(),
            "python": platform.python_version()}


def load_all(args):
    """(experiments, problems): a file that cannot be read is a problem, not the end."""
    files = sorted(args.experiments.glob("*.toml"))
    known = [f.stem for f in files]
    if args.names == ["report"]:
        args.names = [name for name in known if name.startswith("report_")]
    for name in args.names:
        if name not in known:
            print(f"corsac lab: no experiment '{name}'; known: {', '.join(known)}", file=sys.stderr)
            sys.exit(2)
    found, problems = [], []
    for file in files:
        if args.names and file.stem not in args.names:
            continue
        try:
            exp = experiment.load(file, args.quick)
        except experiment.BadExperiment as err:
            problems.append(str(err))
            continue
        if args.names or exp.quick or not args.quick:
            found.append(exp)
    return found, problems


def rows_of(exp, accuracy, timing):
    rows = []
    for index, (label, point) in enumerate(exp.points()):
        runs = accuracy[index * len(exp.seeds):(index + 1) * len(exp.seeds)]
        error = judge.summary([r.get(exp.error.get("key")) for r in runs])
        cost = judge.summary([r.get(exp.cost.get("key")) for r in timing[index]]) if timing else None
        settings = {k: v for k, v in exp.params(label, point, 0).items() if k != "seed" and k not in exp.fixed}
        rows.append({"method": label, "point": point, "settings": settings,
                     "tune": exp.methods[label].get("tune", True), "error": error, "cost": cost,
                     "figures": {**runs[0], **({} if not timing else timing[index][0])}})
    return rows


def program_of(args, exp, label):
    """The program that runs a method: the default build, or one built with other flags."""
    name = exp.methods[label].get("binary")
    program = ROOT / exp.binaries[name] if name else Path(args.corsac)
    if not program.exists():
        raise experiment.BadExperiment(f"{program} is missing: `make lab-builds` builds it")
    return str(program)


def run_experiment(args, exp, client):
    folder = args.out / exp.name
    cases = runner.Cases(folder, exp.scene and ROOT / exp.scene)

    def commands(seeds, timed):
        return [runner.command_of(program_of(args, exp, label), exp, exp.params(label, point, seed), timed)
                for label, point in exp.points() for seed in seeds]

    accuracy = runner.run_all(commands(exp.seeds, False), cases, args.jobs, client, exp.name)
    if exp.reference:
        params = [exp.params(label, point, seed) for label, point in exp.points() for seed in exp.seeds]
        accuracy = [references.judge(exp.reference, p, figures) for p, figures in zip(params, accuracy)]
    timing = None
    if exp.cost and not args.no_timing:
        timing = runner.time_all(commands(exp.seeds[:1], True), cases, exp.repeats, f"{exp.name}: time")
    rows = rows_of(exp, accuracy, timing)
    broken = [r["broken"] for r in accuracy if "broken" in r]
    checks = [(rule, problems) for rule, problems in judge.check(exp, rows)
              if timing or not any("None" in p for p in problems)]
    return {"experiment": exp, "rows": rows, "broken": broken, "checks": checks,
            "sentence": judge.sentence(exp, rows), "charted": False}


def run_map(args, exp, client):
    import maps
    cases = runner.Cases(args.out / exp.name, exp.scene and ROOT / exp.scene)

    def run(params):
        words = [runner.command_of(args.corsac, exp, p, False) for p in params]
        found = runner.run_all(words, cases, args.jobs, client, exp.name)
        return [references.judge(exp.reference, p, f) for p, f in zip(params, found)] if exp.reference else found

    result = maps.build(exp, run)
    words = [f"{label}: {m['stable']} of {len(m['samples'])} samples stable" for label, m in result["methods"].items()]
    return {"experiment": exp, "rows": [], "broken": [], "checks": [], "map": result, "sentence": "; ".join(words) + ".",
            "charted": False}


def write_results(args, result):
    import chart
    exp = result["experiment"]
    folder = args.out / exp.name
    if "map" in result:
        chart.draw_map(exp, result["map"], folder / exp.name)
        result["map"]["sentence"] = result["sentence"]
        (folder / "map.json").write_text(json.dumps(result["map"], indent=1) + "\n")
        result["charted"] = True
        return
    if (exp.error and exp.cost) or "x" in exp.chart:
        chart.draw(exp, result["rows"], folder / exp.name)
        result["charted"] = True
    data = {"experiment": exp.name, "digest": exp.digest, "quick": args.quick and exp.shortened, "title": exp.title, "sentence": result["sentence"],
            "machine": machine_facts(), "rows": [{k: v for k, v in r.items() if k != "figures"} for r in result["rows"]],
            "expectations": [{"rule": rule, "problems": problems} for rule, problems in result["checks"]],
            "broken": result["broken"]}
    (folder / "result.json").write_text(json.dumps(data, indent=1) + "\n")


def finish(args, results, problems):
    import report
    report.write(args.out / "report.html", results, machine_facts())
    short = 0
    for result in results:
        exp = result["experiment"]
        bad = [p for _, found in result["checks"] for p in found]
        short += bool(bad or result["broken"])
        print(f"{'BROKEN' if result['broken'] else 'FELL SHORT' if bad else 'ok':10} {exp.name}: {result['sentence']}")
        for line in (result["broken"][:3] + bad)[:6]:
            print(f"           {line}")
    for problem in problems:
        print(f"BROKEN     {problem}")
    print(f"{args.out / 'report.html'}: {len(results)} experiments, {short + len(problems)} with problems")
    return 3 if short or problems else 0


def main(argv=None):
    args = arguments(argv)
    found, problems = load_all(args)
    if args.list:
        for exp in found:
            print(f"{exp.name:20} {exp.title}{' (quick)' if exp.quick else ''}")
        return 0
    args.out.mkdir(parents=True, exist_ok=True)
    client = None
    if args.scheduler:
        from dask.distributed import Client
        client = Client(args.scheduler)
        client.upload_file(str(Path(__file__).resolve().parent / "run.py"))
    results = []
    for exp in found:
        try:
            result = run_map(args, exp, client) if exp.map else run_experiment(args, exp, client)
            write_results(args, result)
            results.append(result)
        except Exception as err:  # one broken experiment is named and does not stop the rest
            problems.append(f"{exp.name}: {type(err).__name__}: {err}")
    return finish(args, results, problems)


if __name__ == "__main__":
    sys.exit(main())
