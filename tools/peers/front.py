"""Time against error: every engine at every setting of its own, drawn as one SVG of panels."""

import math
import os
import statistics
from html import escape

SCENES = [  # title, words, time, error, scale, label of the error
    ("S1 1,000 balls at rest", "s1 --n=1000 --steps=360", "ms_settled", "pen_mean_end", 1e3, "mean overlap, mm"),
    ("S2 pyramid of 40", "s2 --n=40 --steps=200", "ms_settled", "top_sag", 1e3, "sag of the top, mm"),
    ("S4 a box under 1:100", "s4 --n=1 --arg=100 --steps=600", "ms_settled", "top_sag", 1e3, "sag of the top, mm"),
    ("S7 chain of 50, end 1:1", "s7 --n=50 --arg=1", "ms_med", "joint_err_max", 1e3, "worst gap, mm"),
    ("S7 chain of 50, end 1:100", "s7 --n=50 --arg=100", "ms_med", "joint_err_max", 1e3, "worst gap, mm"),
    ("S9 cloth of rods 40x40", "s9 --n=40 --steps=300", "ms_med", "rod_err_mean_worst", 1e2, "mean rod error, %"),
]
OWN = ("auto", "2", "4", "8", "12", "16", "24", "32")  # Corsac's substeps
PRESETS = ("0", "1", "2")  # of a peer, see its adapter
COLORS = {"corsac": "#c1440e", "box3d": "#3a6ea5", "bullet": "#5b8c5a", "ode": "#8e6c8a"}
FLOOR = 1e-4  # smaller errors are drawn here


def measure(runs, engine, scene):
    """[(setting, ms, error)] of one engine, best of settings that stand."""
    title, words, time, error, scale, _ = scene
    points = []
    for setting in OWN if engine == "corsac" else PRESETS:
        if engine == "corsac":
            os.environ["CORSAC_SUBSTEPS"] = "" if setting == "auto" else setting
            full = words
        else:
            full = f"{words} --preset={setting}"
        done = [runs.one(engine, full) for _ in range(runs.repeats)]
        os.environ.pop("CORSAC_SUBSTEPS", None)
        ms = [r[time] for r in done if isinstance(r.get(time), (int, float))]
        off = [r[error] * scale for r in done if isinstance(r.get(error), (int, float))]
        fell = any(r.get("nan") or r.get("lost") or r.get("fell_at_s", -1) >= 0 for r in done)
        if ms and off and not fell and math.isfinite(off[0]):
            points.append((setting, statistics.median(ms), max(abs(statistics.median(off)), FLOOR)))
    return points


def covered(point, points):
    return any(p[1] <= point[1] and p[2] <= point[2] for p in points)


def ticks(lo, hi):
    return [10.0 ** k for k in range(math.floor(math.log10(lo)), math.ceil(math.log10(hi)) + 1)]


def panel(scene, found, x0, y0, width, height):
    """SVG of one scene: logarithmic axes, a line an engine, Corsac's on top."""
    every = [p for points in found.values() for p in points]
    xs, ys = ticks(min(p[1] for p in every), max(p[1] for p in every)), ticks(min(p[2] for p in every),
                                                                              max(p[2] for p in every))

    def place(p):
        u = math.log10(p[1] / xs[0]) / max(math.log10(xs[-1] / xs[0]), 1e-9)
        v = math.log10(p[2] / ys[0]) / max(math.log10(ys[-1] / ys[0]), 1e-9)
        return x0 + u * width, y0 + height - v * height

    out = [f'<text x="{x0}" y="{y0 - 8}" font-weight="bold">{escape(scene[0])}</text>',
           f'<text x="{x0 + width}" y="{y0 + height + 28}" text-anchor="end">ms per step</text>',
           f'<text x="{x0 + width}" y="{y0 - 8}" text-anchor="end">{escape(scene[5])}</text>']
    for value in xs:
        x, _ = place(("", value, ys[0]))
        out += [f'<path d="M{x:.1f} {y0}V{y0 + height}" stroke="#ddd"/>',
                f'<text x="{x:.1f}" y="{y0 + height + 14}" text-anchor="middle">{value:g}</text>']
    for value in ys:
        _, y = place(("", xs[0], value))
        out += [f'<path d="M{x0} {y:.1f}H{x0 + width}" stroke="#ddd"/>',
                f'<text x="{x0 - 4}" y="{y + 4:.1f}" text-anchor="end">{value:g}</text>']
    for engine in sorted(found, key=lambda e: e == "corsac"):
        color, at = COLORS.get(engine, "#555"), [place(p) for p in sorted(found[engine], key=lambda p: p[1])]
        line = " ".join(f"{x:.1f},{y:.1f}" for x, y in at)
        out.append(f'<polyline points="{line}" fill="none" stroke="{color}" stroke-width="1.5"/>')
        out += [f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3.5" fill="{color}"/>' for x, y in at]
        for point in found[engine]:
            if engine == "corsac":
                x, y = place(point)
                out.append(f'<text x="{x + 5:.1f}" y="{y - 4:.1f}" fill="{color}">{escape(point[0])}</text>')
    return out


def draw(results, path):
    columns, width, height = 3, 250, 190
    rows = math.ceil(len(results) / columns)
    w, h = columns * (width + 80), rows * (height + 70) + 40
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{w}" height="{h}" viewBox="0 0 {w} {h}" '
           'font-family="sans-serif" font-size="10">', f'<rect width="{w}" height="{h}" fill="white"/>']
    for index, (scene, found) in enumerate(results):
        out += panel(scene, found, 55 + index % columns * (width + 80), 30 + index // columns * (height + 70),
                     width, height)
    names = sorted({e for _, found in results for e in found}, key=list(COLORS).index)
    for index, engine in enumerate(names):
        x = 60 + 150 * index
        out += [f'<circle cx="{x}" cy="{h - 18}" r="4" fill="{COLORS[engine]}"/>',
                f'<text x="{x + 9}" y="{h - 14}">{engine + (", sub-steps" if engine == "corsac" else "")}</text>']
    path.write_text("\n".join([*out, "</svg>"]) + "\n")


def run(runs, engines, path):
    """Measures, prints what covers what, draws. Returns plain data."""
    results = []
    print("\ntime against error; a peer's setting is covered when Corsac has one that is no slower and no worse\n")
    for scene in SCENES:
        found = {e: points for e in engines if (points := measure(runs, e, scene))}
        own = found.get("corsac", [])
        print(f"{scene[0]} ({scene[5]})")
        for engine, points in found.items():
            shown = "  ".join(f"{s}: {ms:.3g} ms {off:.3g}" for s, ms, off in points)
            left = [p for p in points if not covered(p, own)]
            note = "" if engine == "corsac" else f"  covered {len(points) - len(left)} of {len(points)}"
            print(f"  {engine:8}{shown}{note}", flush=True)
        results.append((scene, found))
    draw(results, path)
    print(f"\nchart: {path}")
    return [{"scene": scene[0], "error": scene[5], "points": found} for scene, found in results]
