"""What `make docs` takes over from out/lab: charts into docs/charts, maps and the fronts of
solvers and integrators into assets/stability.

Each experiment with `docs = true` whose result is there and belongs to the present experiment file is
copied, its digest recorded; `stale()` names those whose committed chart or map is of another file.
"""

import json
import shutil
import sys
import tomllib
from pathlib import Path

from experiment import digest_of

ROOT = Path(__file__).resolve().parents[2]


def chosen():
    """(name, digest, is a map) of every experiment whose chart is committed."""
    for file in sorted((ROOT / "scripts/lab").glob("*.toml")):
        raw = tomllib.loads(file.read_text())
        if raw.get("docs"):
            yield file.stem, digest_of(raw), "map" in raw


def recorded(name):
    """Digest of the experiment file that the committed chart or map was made from."""
    index = ROOT / "docs/charts/index.json"
    return json.loads(index.read_text()).get(name, {}).get("digest") if index.exists() else None


def stale():
    """Lines of what is missing, of another experiment file, or of none."""
    names = set()
    for name, digest, is_map in chosen():
        names.add(name)
        files = [ROOT / f"docs/charts/{name}.svg"] + [ROOT / f"assets/stability/{name}.json"] * is_map
        for file in files:
            if not file.exists():
                yield f"{file.relative_to(ROOT)} is missing: run `corsac lab {name}`, then `make docs`"
        if recorded(name) != digest:
            yield f"docs/charts/{name}.svg: scripts/lab/{name}.toml has changed since: run `corsac lab {name}`, then `make docs`"
        elif is_map and files[1].exists() and json.loads(files[1].read_text()).get("digest") != digest:
            yield f"assets/stability/{name}.json: scripts/lab/{name}.toml has changed since"
    for file in [*(ROOT / "docs/charts").glob("*.svg"), *(ROOT / "assets/stability").glob("*.json")]:
        if file.stem not in names and file.name != "fronts.json" and not file.stem.startswith("peers_"):
            yield f"{file.relative_to(ROOT)}: no experiment of that name with `docs = true`"


def compact(result):
    """A map with one sample a line."""
    text = json.dumps({k: v for k, v in result.items() if k != "methods"}, indent=1)[:-2] + ',\n "methods": {\n'
    methods = []
    for label, m in result["methods"].items():
        samples = ",\n    ".join(json.dumps([s["x"], s["y"], s["verdict"]]) for s in m["samples"])
        methods.append(f'  {json.dumps(label)}: {{"params": {json.dumps(m["params"])}, "samples": [\n    {samples}]}}')
    return text + ",\n".join(methods) + "\n }\n}\n"


def front_rows(result):
    """What `corsac tune` searches: the settings of a front at the default step, their error and cost."""
    return [{"settings": {k: v for k, v in r["settings"].items() if k != "dt"}, "error": r["error"]["median"],
             "cost": r["cost"]["median"]} for r in result["rows"]
            if r["error"] and r["cost"] and r.get("tune", True) and abs(60 * r["settings"].get("dt", 1 / 60) - 1) < 1e-3]


def publish(out):
    if not out.is_dir():
        return  # no lab run here: what is committed stays
    index_path = ROOT / "docs/charts/index.json"
    index = json.loads(index_path.read_text()) if index_path.exists() else {}
    index_path.parent.mkdir(parents=True, exist_ok=True)
    (ROOT / "assets/stability").mkdir(parents=True, exist_ok=True)
    fronts_path = ROOT / "assets/stability/fronts.json"
    fronts = json.loads(fronts_path.read_text()) if fronts_path.exists() else {}
    known = {name for name, _, _ in chosen()}
    index = {name: entry for name, entry in index.items() if name in known}
    for name, digest, is_map in chosen():
        folder = out / name
        data = folder / ("map.json" if is_map else "result.json")
        result = json.loads(data.read_text()) if data.exists() else {}
        if result.get("digest") != digest or result.get("quick"):
            continue
        shutil.copy(folder / f"{name}.svg", ROOT / f"docs/charts/{name}.svg")
        index[name] = {"digest": digest, "title": result["title"], "sentence": result.get("sentence", "")}
        if name.startswith(("contact_", "world_")):
            fronts[name] = front_rows(result)
        if is_map:
            (ROOT / f"assets/stability/{name}.json").write_text(compact(result))
    fronts_path.write_text(json.dumps({k: fronts[k] for k in sorted(fronts) if k in known}, indent=1) + "\n")
    index_path.write_text(json.dumps(index, indent=1, sort_keys=True, ensure_ascii=False) + "\n")


if __name__ == "__main__":
    publish(ROOT / "out/lab")
    for line in stale():
        print(line, file=sys.stderr)
