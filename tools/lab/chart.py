"""Charts as SVG and PNG: cost against error on logarithmic axes, lines over a sweep, stability maps."""

import math

import matplotlib

matplotlib.use("Agg")
matplotlib.rcParams.update({"svg.hashsalt": "corsac", "svg.fonttype": "none", "font.size": 9,
                            "axes.grid": True, "grid.alpha": 0.25, "axes.axisbelow": True})
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.colors import ListedColormap  # noqa: E402
from matplotlib.ticker import LogFormatterSciNotation, NullFormatter  # noqa: E402

from judge import front  # noqa: E402

MARKS = "osD^vP*Xh<>"
TINY = 1e-17  # where an error of exactly 0 is drawn on a logarithmic axis


def axis_label(what):
    unit = what.get("unit", "")
    return what.get("label", what["key"]) + (f" ({unit})" if unit else "")


def panels_of(exp, rows):
    """[(title, rows)] by the chart's panel sweep."""
    name = exp.chart.get("panel")
    if not name:
        return [("", rows)]
    return [(f"{name} = {shown_value(name, v)}", [r for r in rows if r["point"].get(name) == v])
            for v in exp.sweep[name]]


def shown_value(name, value):
    """Step lengths as fractions of a second."""
    return f"1/{round(1 / value)} s" if name == "dt" and value < 1 else value


def style(exp, label):
    kind = exp.methods[label]
    index = list(exp.methods).index(label)
    return {"marker": MARKS[index % len(MARKS)], "color": f"C{index % 10}",
            "linestyle": ":" if kind.get("peer") else "--" if kind.get("baseline") else "-",
            "label": label + (" (peer)" if kind.get("peer") else " (baseline)" if kind.get("baseline") else "")}


def quiet_ticks(axis):
    """Labels between decades only where the axis spans less than one."""
    lo, hi = axis.get_view_interval()
    narrow = lo > 0 and hi / lo < 10
    axis.set_minor_formatter(LogFormatterSciNotation(minor_thresholds=(2, 0.5)) if narrow else NullFormatter())


def draw_front(ax, exp, rows):
    for label in exp.methods:
        mine = [r for r in rows if r["method"] == label and r["error"] and r["cost"]]
        mine.sort(key=lambda r: r["cost"]["median"])
        if not mine:
            continue
        x = [r["cost"]["median"] for r in mine]
        y = [max(r["error"]["median"], TINY) for r in mine]
        spread = [[a - r["cost"]["lo"] for a, r in zip(x, mine)], [r["cost"]["hi"] - a for a, r in zip(x, mine)]]
        look = style(exp, label)
        if exp.chart.get("scatter"):
            look["linestyle"] = "none"
            for row, at, error in zip(mine, x, y):
                ax.annotate(str(next(iter(row["point"].values()))), (at, error), fontsize=6,
                            xytext=(3, 3), textcoords="offset points")
        ax.errorbar(x, y, xerr=spread, markersize=5, linewidth=1, capsize=2, **look)
    best = front(rows)
    if len(best) > 1 and not exp.chart.get("scatter"):
        ax.plot([r["cost"]["median"] for r in best], [max(r["error"]["median"], TINY) for r in best],
                color="black", linewidth=3, alpha=0.15, label="front", zorder=0)
    ax.set(xscale="log", yscale="log", xlabel=axis_label(exp.cost), ylabel=axis_label(exp.error))
    quiet_ticks(ax.xaxis)
    quiet_ticks(ax.yaxis)


def value_of(row, key):
    value = row[key] and row[key]["median"] if key in ("error", "cost") else row["figures"].get(key)
    return max(value, TINY) if isinstance(value, (int, float)) and math.isfinite(value) else None


def draw_bars(ax, exp, rows, key):
    """Names on the x axis: one group of bars each."""
    names, width = exp.sweep[exp.chart["x"]], 0.8 / len(exp.methods)
    for index, label in enumerate(exp.methods):
        points = [(names.index(r["point"][exp.chart["x"]]), value_of(r, key)) for r in rows if r["method"] == label]
        look = style(exp, label)
        ax.bar([i + (index - (len(exp.methods) - 1) / 2) * width for i, v in points if v is not None],
               [v for _, v in points if v is not None], width, color=look["color"], label=look["label"],
               alpha=0.5 if exp.methods[label].get("baseline") else 1)
    ax.set_xticks(range(len(names)), names)


def draw_line(ax, exp, rows):
    key = exp.chart.get("y", "error")
    what = exp.cost if key == "cost" else exp.error if key == "error" else {"key": key}
    values = exp.sweep[exp.chart["x"]]
    if any(isinstance(v, str) for v in values):
        draw_bars(ax, exp, rows, key)
    else:
        for label in exp.methods:
            points = sorted((r["point"][exp.chart["x"]], value_of(r, key)) for r in rows
                            if r["method"] == label and value_of(r, key) is not None)
            if points:
                ax.plot(*zip(*points), markersize=5, linewidth=1, **style(exp, label))
        if min(values) > 0:
            ax.set_xscale("log")
        for mark in exp.stated:
            ax.plot([mark["x"]], [mark["y"]], "k*", markersize=9)
            ax.annotate(mark["text"], (mark["x"], mark["y"]), fontsize=7, xytext=(-4, 6), textcoords="offset points",
                        ha="right")
    ax.set(xlabel=exp.chart["x"], ylabel=axis_label(what))
    if not exp.chart.get("linear"):
        ax.set_yscale("log")
        quiet_ticks(ax.yaxis)


def save(figure, path):
    figure.savefig(path.with_suffix(".svg"), metadata={"Date": None})
    figure.savefig(path.with_suffix(".png"), dpi=110)
    plt.close(figure)


def draw(exp, rows, path):
    """The experiment's chart beside `path`; nothing when there is nothing to draw."""
    panels = panels_of(exp, rows)
    columns = min(3, len(panels))
    lines = math.ceil(len(panels) / columns)
    figure, axes = plt.subplots(lines, columns, figsize=(4.6 * columns + 0.6, 3.6 * lines + 0.5), squeeze=False,
                                layout="constrained")
    for ax, (title, mine) in zip(axes.flat, panels):
        (draw_line if "x" in exp.chart else draw_front)(ax, exp, mine)
        ax.set_title(title)
    for ax in list(axes.flat)[len(panels):]:
        ax.set_visible(False)
    handles, labels = axes.flat[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=max(1, min(len(labels), 2 * columns)),
                  frameon=False)
    figure.suptitle(exp.title)
    save(figure, path)


VERDICTS = {"stable": "#d9ead9", "explodes": "#7a0c0c", "falls": "#7a0c0c", "tunnels": "#7a0c0c", "sinks": "#d1495b",
            "drifts": "#edae49", "gains energy": "#d1495b", "loses energy": "#00798c", "oscillates": "#9c89b8",
            "shadows itself": "#7a0c0c", "leaks": "#edae49", "fights": "#d1495b", "mostly over": "#d1495b",
            "overflows": "#edae49", "pops": "#d1495b", "leaks much": "#7a0c0c", "overlaps": "#d1495b",
            "does not arrive": "#edae49", "promised": "#7a0c0c", "not climbed": "#edae49", "breaks": "#7a0c0c"}


def share(axis, value):
    """Place of a value on its axis, 0 to 1."""
    lo, hi = axis["lo"], axis["hi"]
    return math.log(value / lo) / math.log(hi / lo) if axis.get("log") else (value - lo) / (hi - lo)


def shade(ax, exp, samples, cells=120):
    """Colours every place by its nearest sample, lightly."""
    places = [(share(exp.map["x"], s["x"]), share(exp.map["y"], s["y"]), s["verdict"]) for s in samples]
    names = list(VERDICTS)
    grid = [[names.index(min(places, key=lambda p: (p[0] - (i + 0.5) / cells) ** 2 + (p[1] - (j + 0.5) / cells) ** 2)[2])
             for i in range(cells)] for j in range(cells)]
    edges = [[(axis["lo"] * (axis["hi"] / axis["lo"]) ** (i / cells) if axis.get("log")
               else axis["lo"] + (axis["hi"] - axis["lo"]) * i / cells) for i in range(cells + 1)]
             for axis in (exp.map["x"], exp.map["y"])]
    ax.pcolormesh(edges[0], edges[1], grid, cmap=ListedColormap(VERDICTS.values()), vmin=-0.5,
                  vmax=len(names) - 0.5, alpha=0.45, rasterized=True, linewidth=0)


def draw_map(exp, result, path):
    """Where each method fails: one panel a method, colour = the first criterion that failed."""
    methods = list(result["methods"])
    seen = [n for n in VERDICTS if any(s["verdict"] == n for m in methods for s in result["methods"][m]["samples"])]
    figure, axes = plt.subplots(1, len(methods), figsize=(4.4 * len(methods) + 0.8, 4.6), squeeze=False,
                                layout="constrained")
    for ax, label in zip(axes.flat, methods):
        samples = result["methods"][label]["samples"]
        for axis, set_scale in (("x", ax.set_xscale), ("y", ax.set_yscale)):
            if exp.map[axis].get("log"):
                set_scale("log")
        shade(ax, exp, samples)
        for name in seen:
            mine = [s for s in samples if s["verdict"] == name]
            ax.scatter([s["x"] for s in mine], [s["y"] for s in mine], color=VERDICTS[name], s=20, label=name,
                       marker="s" if name == "stable" else "o", edgecolors="black", linewidths=0.3)
        ax.set(xlabel=exp.map["x"].get("label", exp.map["x"]["name"]),
               ylabel=exp.map["y"].get("label", exp.map["y"]["name"]), title=label)
    figure.legend(*axes.flat[0].get_legend_handles_labels(), loc="outside lower center", ncols=6, frameon=False)
    figure.suptitle(exp.title)
    save(figure, path)
