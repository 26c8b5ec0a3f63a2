#!/usr/bin/env python3
"""Writes docs/from-the-report.md from docs/report-rows.txt; --check only compares.

A row is `id | what the report names | C names | Lua names | tests | issue that will do it`. Names are
checked: a C name must stand in a header, shader or makefile of the tree, a Lua name in docs/api.md, a
test must be a file, or FILE:NAME with NAME in that file. A row without a test is not done and must
say which issue will do it.
"""
import argparse
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
ROWS = ROOT / "docs/report-rows.txt"
TABLE = ROOT / "docs/from-the-report.md"
HEAD = """# From the report to the code

Corsac grew from a student report on the Vulpine engine (2024). This table says where each thing that
the report names lives here, under its C and its Lua name, and which test holds it. It is generated
from `report-rows.txt` by `tools/report_table.py`; `make lint` fails when a row names something that
does not exist.
"""


def words_of(patterns):
    words = set()
    for pattern in patterns:
        for path in ROOT.glob(pattern):
            words.update(re.findall(r"[A-Za-z_][A-Za-z0-9_]*", path.read_text(errors="replace")))
    return words


def names(cell):
    return [n.strip() for n in cell.split(",") if n.strip() not in ("", "-")]


def check_row(where, row, c_words, lua_text):
    problems = []
    for name in names(row[2]):
        is_file = (ROOT / name).is_file()
        if not is_file and name not in c_words:
            problems.append(f"{where}: C name '{name}' stands in no header, shader or makefile")
    for name in names(row[3]):
        if not re.search(r"(?<![\w.])" + re.escape(name) + r"(?!\w)", lua_text):
            problems.append(f"{where}: Lua name '{name}' is not in docs/api.md")
    for test in names(row[4]):
        path, _, name = test.partition(":")
        file = ROOT / path
        if not file.is_file():
            problems.append(f"{where}: test file '{path}' does not exist")
        elif name and not re.search(r"\b" + re.escape(name) + r"\b", file.read_text()):
            problems.append(f"{where}: test '{name}' is not in {path}")
    if not names(row[4]) and not row[5]:
        problems.append(f"{where}: neither a test nor the issue that will do it")
    return problems


def cell(text, code=True):
    listed = names(text)
    return ", ".join(f"`{n}`" if code else n for n in listed) if listed else "–"


def build():
    c_words = words_of(["engine/**/*.h", "assets/shaders/**/*", "Makefile"])
    api = ROOT / "docs/api.md"
    lua_text = api.read_text() if api.is_file() else ""
    out, problems, done, total = [HEAD], [], 0, 0
    for number, line in enumerate(ROWS.read_text().splitlines(), 1):
        if not line.strip():
            continue
        if line.startswith("# "):
            out.append(f"\n## {line[2:]}\n\n| id | the report | C | Lua | test |\n|---|---|---|---|---|")
            continue
        row = [c.strip() for c in line.split("|")]
        where = f"{ROWS.relative_to(ROOT)}:{number}"
        if len(row) != 6:
            problems.append(f"{where}: expected 6 cells, found {len(row)}")
            continue
        problems += check_row(where, row, c_words, lua_text)
        total += 1
        tested = bool(names(row[4])) and not row[5]
        done += tested
        test = cell(row[4])
        if row[5]:
            test = f"to come: {row[5]}" if test == "–" else f"{test}; the rest: {row[5]}"
        out.append(f"| {row[0]} | {row[1]} | {cell(row[2])} | {cell(row[3])} | {test} |")
    out.append(f"\n{done} of {total} rows are done.\n")
    return "\n".join(out), problems


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--check", action="store_true", help="compare, write nothing")
    args = parser.parse_args()
    text, problems = build()
    for problem in problems:
        print(problem, file=sys.stderr)
    if args.check:
        if not TABLE.is_file() or TABLE.read_text() != text:
            print(f"{TABLE.relative_to(ROOT)} is stale: run `make docs`", file=sys.stderr)
            return 1
    else:
        TABLE.write_text(text)
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
