#!/usr/bin/env python3
"""Checks the tree's own rules; prints what breaks them and one line `N passed, N failed`.

    tools/lint.py [CHECK...]      all checks, or only those named

Checks: format, lua, python, length, rooms, lua_h, headers, flags, words, links, report, shell, lab.
"""

import ast
import re
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
ROOMS = ("phys", "gfx", "anim", "nav", "audio", "asset")
CLANG_FORMAT = 14  # Debian 12; other versions lay some lines out differently


class Skip(Exception):
    """A check that this machine cannot make, and why."""


def tracked(*patterns):
    """Files of the tree that match, committed or new, without what git ignores."""
    listed = subprocess.run(["git", "ls-files", "-co", "--exclude-standard", "-z", "--", *patterns],
                            cwd=ROOT, capture_output=True, check=True).stdout.decode()
    return sorted(ROOT / name for name in set(listed.split("\0")) if name and (ROOT / name).is_file())


def shown(path):
    return str(path.relative_to(ROOT))


def output_of(command):
    done = subprocess.run(command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    return done.returncode, done.stdout


def lines_matching(paths, pattern, message):
    for path in paths:
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
            if pattern.search(line):
                yield f"{shown(path)}:{number}: {message}: {line.strip()}"


def check_format():
    """C sources are laid out by clang-format."""
    files = tracked("*.c", "*.h")
    version = int(re.search(r"version (\d+)", output_of(["clang-format", "--version"])[1]).group(1))
    if version != CLANG_FORMAT:
        raise Skip(f"clang-format {CLANG_FORMAT} is the judge, this one is {version}")
    code, text = output_of(["clang-format", "--dry-run", "-Werror", *map(str, files)]) if files else (0, "")
    if code != 0:
        yield from (line for line in text.splitlines() if "error:" in line)
        yield "`make fmt` lays them out"


def check_lua():
    """Lua files pass luacheck (.luacheckrc)."""
    files = tracked("*.lua")
    if not files:
        return
    code, text = output_of(["luacheck", "-q", "--no-color", "--codes", *map(str, files)])
    if code != 0:
        yield from (line for line in text.splitlines() if line.strip())


def check_python():
    """Python files parse."""
    for path in tracked("*.py"):
        try:
            ast.parse(path.read_text(encoding="utf-8"), shown(path))
        except SyntaxError as error:
            yield f"{shown(path)}:{error.lineno}: {error.msg}"


def check_shell():
    """Shell scripts parse."""
    for path in tracked("*.sh", ".ci/run"):
        code, text = output_of(["bash", "-n", str(path)])
        if code != 0:
            yield text.strip()


def check_length():
    """No source file is longer than 1,000 lines (the editor stubs are generated)."""
    for path in tracked("*.c", "*.h", "*.lua", "*.py", "*.sh", "*.glsl", "*.vert", "*.frag", "*.comp"):
        if shown(path).startswith("scripts/types/"):
            continue
        count = len(path.read_text(encoding="utf-8").splitlines())
        if count > 1000:
            yield f"{shown(path)}: {count} lines; at most 1000"


def allowed_rooms(folder):
    """What a folder of engine/ may include, by the arrows of the design: they run down only."""
    if folder == "core":
        return {"core"}
    if folder in ROOMS:
        return {"core", folder}
    below = {"core", *ROOMS, "scene"}
    return {"scene": below, "script": below | {"script"}, "app": below | {"script", "app"}}[folder]


def check_rooms():
    """Includes run down only: app, script, scene, rooms, core; no room includes another."""
    include = re.compile(r'^\s*#\s*include\s+"([a-z]+)/')
    for path in tracked("engine/*.c", "engine/*.h"):
        folder = path.relative_to(ROOT).parts[1]
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
            found = include.match(line)
            if found and found.group(1) not in allowed_rooms(folder):
                yield f"{shown(path)}:{number}: engine/{folder} must not include {found.group(1)}/"


def check_lua_h():
    """lua.h stays in engine/script, OpenGL in engine/gfx; no cglm or GL in public headers."""
    sources = tracked("engine/*.c", "engine/*.h")
    outside = [p for p in sources if p.relative_to(ROOT).parts[1] not in ("script", "app")]
    yield from lines_matching(outside, re.compile(r"#\s*include\s*[<\"](lua|lauxlib|lualib|luajit)\.h"),
                              "Lua outside engine/script")
    outside = [p for p in sources if p.relative_to(ROOT).parts[1] != "gfx"]
    yield from lines_matching(outside, re.compile(r"#\s*include\s*[<\"](glad|GL|EGL|GLFW)/"),
                              "OpenGL outside engine/gfx")
    yield from lines_matching(public_headers(), re.compile(r"#\s*include\s*[<\"](cglm|glad|GL|EGL|GLFW)/"),
                              "not for a public header")


def public_headers():
    """engine/ROOM/ROOM.h and those headers of core that stand alone."""
    rooms = [p for p in tracked("engine/*.h") if p.stem == p.parent.name]
    core = [p for p in tracked("engine/core/*.h") if not re.search(r"simd_|internal", p.name)]
    return sorted(set(rooms + core))


def check_headers():
    """Every public header compiles alone, as C17 and as C++17."""
    flags = ["-fsyntax-only", "-Iengine", "-Wall", "-Wextra", "-Werror", "-D_GNU_SOURCE"]

    def compile_alone(job):
        path, compiler, standard = job
        with tempfile.TemporaryDirectory() as folder:
            unit = Path(folder) / ("alone" + (".c" if compiler == "gcc" else ".cpp"))
            unit.write_text(f'#include "{path.relative_to(ROOT / "engine")}"\n')
            code, text = output_of([compiler, standard, *flags, str(unit)])
        return "" if code == 0 else f"{shown(path)} does not compile alone as {standard[5:]}:\n{text}"

    jobs = [(path, *how) for path in public_headers()
            for how in (("gcc", "-std=c17"), ("g++", "-std=c++17"))]
    with ThreadPoolExecutor() as pool:
        yield from filter(None, pool.map(compile_alone, jobs))


def check_flags():
    """The build never allows itself inexact arithmetic."""
    build = tracked("Makefile", "*.mk")
    pattern = re.compile(r"-Ofast|-ffast-math|-mfma|-march=native|-funsafe-math|-fassociative-math")
    for problem in lines_matching(build, pattern, "forbidden flag"):
        if "lab-ofast" not in problem:
            yield problem
    if "-ffp-contract=off" not in (ROOT / "Makefile").read_text():
        yield "Makefile: -ffp-contract=off is missing"


def check_words():
    """No notes to self, no commented-out code markers, no addresses of somebody's machine."""
    own = Path(__file__).resolve()
    sources = [p for p in tracked("engine", "scripts", "tests", "tools", "assets", "Makefile", ".ci/run")
               if p != own and p.suffix in (".c", ".h", ".lua", ".py", ".sh", ".mk", ".glsl", ".vert", ".frag",
                                            ".comp", "")]
    yield from lines_matching(sources, re.compile(r"\b(TODO|FIXME|XXX|HACK)\b|^\s*#\s*if 0\b"),
                              "unfinished work belongs in the issues")
    yield from lines_matching(sources, re.compile(r"(?<![\w.])/(home|work|tmp|root)/\w"), "path of a machine")


def check_links():
    """Links in Markdown files lead to files that exist."""
    link = re.compile(r"!?\[[^\]]*\]\(([^)\s#]+)(?:#[^)]*)?\)")
    for path in tracked("*.md"):
        text = re.sub(r"```.*?```", "", path.read_text(encoding="utf-8"), flags=re.S)
        for target in link.findall(text):
            if not re.match(r"[a-z]+:", target) and not (path.parent / target).exists():
                yield f"{shown(path)}: no file {target}"


def check_report():
    """docs/from-the-report.md is fresh and every name in it exists."""
    code, text = output_of([sys.executable, "tools/report_table.py", "--check"])
    if code != 0:
        yield from text.splitlines()


def check_lab():
    """Committed charts and stability maps are of the present experiment files."""
    sys.path.insert(0, str(ROOT / "tools/lab"))
    import publish
    yield from publish.stale()


def main():
    checks = {name[6:]: check for name, check in globals().items() if name.startswith("check_")}
    unknown = [name for name in sys.argv[1:] if name not in checks]
    if unknown:
        print(f"unknown check {unknown[0]}; known: {' '.join(checks)}", file=sys.stderr)
        return 2
    passed = failed = skipped = 0
    for name in sys.argv[1:] or checks:
        about = f"{name}: {checks[name].__doc__}"
        try:
            problems = list(checks[name]())
        except Skip as reason:
            skipped += 1
            print(f"skip  {about} ({reason})")
            continue
        passed += not problems
        failed += bool(problems)
        print(f"{'FAIL' if problems else 'ok':4}  {about}")
        for problem in problems:
            print("    " + problem.replace("\n", "\n    "))
    print(f"{passed} passed, {failed} failed" + (f", {skipped} skipped" if skipped else ""))
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
