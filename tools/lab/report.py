"""One HTML page: every chart with a plain sentence under it, what was expected and what broke."""

import html

STYLE = """body{font:15px/1.5 system-ui,sans-serif;max-width:70em;margin:2em auto;padding:0 1em;color:#222}
img{max-width:100%}section{margin:2.5em 0;border-top:1px solid #ccc}.bad{color:#a11}.good{color:#171}
table{border-collapse:collapse;font-size:13px}td,th{border:1px solid #ddd;padding:2px 8px;text-align:right}
th:first-child,td:first-child{text-align:left}summary{cursor:pointer}"""


def shown(value):
    return "–" if value is None else f"{value['median']:.4g}" if isinstance(value, dict) else html.escape(str(value))


def table(exp, rows):
    heads = ["method", *exp.sweep, exp.error.get("label", "error"), exp.cost.get("label", "cost"), "spread of cost"]
    lines = ["<tr>" + "".join(f"<th>{html.escape(str(h))}</th>" for h in heads) + "</tr>"]
    for row in rows:
        cost = row["cost"]
        spread = f"{cost['lo']:.4g} … {cost['hi']:.4g}" if cost else "–"
        cells = [row["method"], *row["point"].values(), shown(row["error"]), shown(cost), spread]
        lines.append("<tr>" + "".join(f"<td>{html.escape(str(c))}</td>" for c in cells) + "</tr>")
    return "<details><summary>figures</summary><table>" + "\n".join(lines) + "</table></details>"


def section(result):
    exp = result["experiment"]
    out = [f"<section id='{exp.name}'><h2>{html.escape(exp.title)}</h2>", f"<p>{html.escape(exp.question)}</p>"]
    if result.get("charted"):
        out.append(f"<img src='{exp.name}/{exp.name}.svg' alt='{html.escape(exp.title)}'>")
    if result["sentence"]:
        out.append(f"<p><b>{html.escape(result['sentence'])}</b></p>")
    out += [f"<p>stated by others: {html.escape(m['text'])}: {m['y']:g} at {m['x']:g}</p>" for m in exp.stated]
    for rule, problems in result["checks"]:
        words = html.escape(", ".join(f"{k} {v}" for k, v in rule.items()))
        mark = "<span class='bad'>fell short</span>" if problems else "<span class='good'>holds</span>"
        out.append(f"<p>{mark}: {words}</p>")
        out += [f"<p class='bad'>&nbsp;&nbsp;{html.escape(p)}</p>" for p in problems]
    out += [f"<p class='bad'>broken: {html.escape(b)}</p>" for b in result["broken"][:5]]
    if result["rows"]:
        out.append(table(exp, result["rows"]))
    return "\n".join(out) + "</section>"


def write(path, results, machine):
    facts = ", ".join(f"{k}: {v}" for k, v in machine.items())
    path.write_text("<!doctype html><html lang='en'><meta charset='utf-8'><title>Corsac lab</title>"
                    f"<style>{STYLE}</style><h1>Corsac lab</h1><p>{html.escape(facts)}</p>"
                    "<p>How to read a chart: each mark is one setting of a method; left is cheaper, lower is more "
                    "accurate; the grey line is the front that no setting beats.</p>"
                    + "\n".join(section(r) for r in results) + "</html>\n")
