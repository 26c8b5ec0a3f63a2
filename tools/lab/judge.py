"""What the figures say: fronts, fitted orders, expectations, and a plain sentence for each chart.

Expectations ([[expect]] in an experiment), each with optional `where = {sweep = value}`:
  kind = "bound"       key, op (<= < >= > ==), value; method (default all): every row holds it
  kind = "order"       method, over (sweep name), order, tolerance; lo, hi: range of the fit
  kind = "equal"       key: one value over all methods (or those of the list `methods`) at each sweep point
  kind = "differ"      key, method, to: the figure differs at one sweep point at least
  kind = "better"      method, to, key, factor: method's figure * factor <= the other's, at each point
  kind = "never_loses" method, to, below: at every error <= below that `to` reaches, method is no dearer
  kind = "monotone"    method, over: the error never rises as the sweep value falls
"""

import math
import operator
import statistics

OPS = {"<=": operator.le, "<": operator.lt, ">=": operator.ge, ">": operator.gt, "==": operator.eq}
NOISE = 1.1  # a cost within 10 % counts as equal on a shared machine


def number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)


def summary(values):
    """Median, lowest, highest of the numbers among values; None without any."""
    found = [v for v in values if number(v)]
    if not found:
        return None
    return {"median": statistics.median(found), "lo": min(found), "hi": max(found)}


def front(rows):
    """Rows that no other row beats in both error and cost, by rising cost."""
    best, kept = math.inf, []
    for row in sorted((r for r in rows if r["error"] and r["cost"]),
                      key=lambda r: (r["cost"]["median"], r["error"]["median"])):
        if row["error"]["median"] < best:
            best = row["error"]["median"]
            kept.append(row)
    return kept


def fit_order(points):
    """Slope of log(error) over log(parameter) by least squares."""
    logs = [(math.log(x), math.log(y)) for x, y in points if x > 0 and y > 0]
    if len(logs) < 2:
        return None
    mx = sum(x for x, _ in logs) / len(logs)
    my = sum(y for _, y in logs) / len(logs)
    return sum((x - mx) * (y - my) for x, y in logs) / sum((x - mx) ** 2 for x, _ in logs)


def chosen(rows, rule, method):
    where = rule.get("where", {})
    return [r for r in rows if (method is None or r["method"] == method)
            and all(r["point"].get(k) == v for k, v in where.items())]


def figure(row, key):
    if key == "error":
        return row["error"]["median"] if row["error"] else None
    if key == "cost":
        return row["cost"]["median"] if row["cost"] else None
    value = row["figures"].get(key)
    return value if value is not None else None


def cheapest(rows, error):
    costs = [r["cost"]["median"] for r in rows if r["error"] and r["cost"] and r["error"]["median"] <= error]
    return min(costs) if costs else None


def check_bound(rows, rule):
    for row in chosen(rows, rule, rule.get("method")):
        value = figure(row, rule["key"])
        if value is None or not OPS[rule["op"]](value, rule["value"]):
            yield f"{row['method']} at {row['point']}: {rule['key']} = {value}, expected {rule['op']} {rule['value']}"


def check_order(rows, rule):
    lo, hi = rule.get("lo", 0), rule.get("hi", math.inf)
    points = [(r["point"][rule["over"]], r["error"]["median"]) for r in chosen(rows, rule, rule["method"])
              if r["error"] and lo <= r["point"][rule["over"]] <= hi]
    order = fit_order(points)
    if order is None or abs(order - rule["order"]) > rule["tolerance"]:
        found = "none" if order is None else f"{order:.2f}"
        yield f"{rule['method']}: order {found} in {rule['over']}, expected {rule['order']} +- {rule['tolerance']}"


def check_equal(rows, rule):
    groups = {}
    for row in chosen(rows, rule, rule.get("method")):
        if row["method"] not in rule.get("methods", [row["method"]]):
            continue
        groups.setdefault(str(row["point"]), []).append((row["method"], figure(row, rule["key"])))
    for point, values in groups.items():
        if len({v for _, v in values}) != 1:
            yield f"{rule['key']} at {point} differs: {values}"


def check_differ(rows, rule):
    other = {str(r["point"]): figure(r, rule["key"]) for r in chosen(rows, rule, rule["to"])}
    mine = [(figure(r, rule["key"]), other.get(str(r["point"]))) for r in chosen(rows, rule, rule["method"])]
    if all(a == b for a, b in mine):
        yield f"{rule['method']} and {rule['to']} have the same {rule['key']} at every point"


def check_better(rows, rule):
    other = {str(r["point"]): r for r in chosen(rows, rule, rule["to"])}
    for row in chosen(rows, rule, rule["method"]):
        a, b = figure(row, rule["key"]), figure(other.get(str(row["point"]), row), rule["key"])
        if a is None or b is None or a * rule.get("factor", 1) > b:
            yield f"{rule['method']} at {row['point']}: {rule['key']} {a}, {rule['to']} has {b}"


def check_never_loses(rows, rule):
    mine, theirs = chosen(rows, rule, rule["method"]), chosen(rows, rule, rule["to"])
    for row in front(theirs):
        error = row["error"]["median"]
        cost = cheapest(mine, error)
        if error <= rule.get("below", math.inf) and (cost is None or cost > NOISE * row["cost"]["median"]):
            yield (f"at error {error:.3g}, {rule['to']} costs {row['cost']['median']:.3g}, "
                   f"{rule['method']} {'never reaches it' if cost is None else f'{cost:.3g}'}")


def check_monotone(rows, rule):
    line = sorted(((r["point"][rule["over"]], r["error"]["median"]) for r in chosen(rows, rule, rule["method"])
                   if r["error"]), reverse=True)
    for (x0, e0), (x1, e1) in zip(line, line[1:]):
        if e1 > e0 * NOISE:
            yield f"{rule['method']}: error rises from {e0:.3g} to {e1:.3g} as {rule['over']} falls {x0} -> {x1}"


def check(exp, rows):
    """(rule, problems) for every expectation."""
    table = {"bound": check_bound, "order": check_order, "equal": check_equal, "differ": check_differ, "better": check_better,
             "never_loses": check_never_loses, "monotone": check_monotone}
    for rule in exp.expect:
        if rule.get("kind") not in table:
            yield rule, [f"unknown kind of expectation '{rule.get('kind')}'; known: {', '.join(table)}"]
            continue
        try:
            yield rule, list(table[rule["kind"]](rows, rule))
        except KeyError as missing:
            yield rule, [f"expectation '{rule['kind']}' lacks the field {missing}"]


def amount(value, unit):
    for scale, prefix in ((1e-9, "n"), (1e-6, "µ"), (1e-3, "m"), (1, "")):
        if unit in ("m", "s", "J", "rad") and abs(value) < scale * 1000 and value:
            return f"{value / scale:.3g} {prefix}{unit}"
    return f"{value:.3g} {unit}".strip()


def parts_of(exp, rows):
    """[(name of the panel, its rows)]."""
    name = exp.chart.get("panel")
    if not name:
        return [("", rows)]
    def shown(v):
        return v if isinstance(v, str) else f"step 1/{round(1 / v)} s" if name == "dt" else f"{name} {v:.4g}"

    return [(f"{shown(v)}: ", [r for r in rows if r["point"].get(name) == v])
            for v in exp.sweep[name]]


def line_sentence(exp, rows):
    """At the last point of the sweep (of names, the first): who is cheapest, and how much dearer the dearest is."""
    axis, unit = exp.chart["x"], exp.cost.get("unit", "")
    end = exp.sweep[axis][0 if isinstance(exp.sweep[axis][0], str) else -1]
    parts = []
    for title, mine in parts_of(exp, rows):
        costs = sorted((r["cost"]["median"], r["method"]) for r in mine if r["point"][axis] == end and r["cost"])
        if len(costs) > 1 and costs[0][0] > 0:
            parts.append(f"{title}{costs[0][1]} {amount(costs[0][0], unit)}, {costs[-1][1]} "
                         f"{costs[-1][0] / costs[0][0]:.3g} times that")
    return f"At {axis} {end}, {exp.cost.get('label', 'cost')}: {'; '.join(parts)}." if parts else ""


def scatter_sentence(exp, rows):
    """Over all points: the worst error and the median cost of each method."""
    parts = []
    for label in exp.methods:
        errors = [r["error"]["median"] for r in rows if r["method"] == label and r["error"]]
        costs = [r["cost"]["median"] for r in rows if r["method"] == label and r["cost"]]
        if errors and costs:
            parts.append(f"{label}: worst {amount(max(errors), exp.error.get('unit', ''))}, "
                         f"median {amount(statistics.median(costs), exp.cost.get('unit', ''))}")
    return "; ".join(parts) + "." if parts else ""


def front_sentence(exp, rows):
    """At the lowest error that two methods reach: who is cheapest and by how much, and who never gets there."""
    best = {}
    for row in rows:
        if row["error"] and row["cost"]:
            error = row["error"]["median"]
            best[row["method"]] = min(error, best.get(row["method"], error))
    if len(best) < 2:
        return ""
    level = sorted(best.values())[1]
    unit = exp.error.get("unit", "")
    reach = [m for m, error in best.items() if error <= level]
    costs = sorted((cheapest([r for r in rows if r["method"] == m], level), m) for m in reach)
    short = [f"{m} ends at {amount(error, unit)}" for m, error in best.items() if error > level]
    (low, who), (high, last) = costs[0], costs[-1]
    what = exp.error.get("label", "error")
    return (f"at {'no ' + what + ' at all' if level == 0 else amount(level, unit) + ' ' + what}, {who} costs "
            f"{amount(low, exp.cost.get('unit', ''))}: {high / low:.3g} times less than {last}"
            + (f" ({', '.join(short)})" if short else "")) if low else ""


def sentence(exp, rows):
    """What a chart says, in plain words."""
    if not exp.chart.get("sentence", True) or not exp.error or not exp.cost:
        return ""
    if "x" in exp.chart:
        return line_sentence(exp, rows)
    if exp.chart.get("scatter"):
        return scatter_sentence(exp, rows)
    parts = [title + text for title, mine in parts_of(exp, rows) if (text := front_sentence(exp, mine))]
    text = "; ".join(parts)
    return text[:1].upper() + text[1:] + "." if text else ""
