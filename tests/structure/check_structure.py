#!/usr/bin/env python3
"""Check that the source tree keeps to the order in which data flows. Usage: check_structure.py ROOT

A library (a folder of include/abbe and of src/abbe) includes only itself and those above it in ORDER; `identify` and
`compensate` do not see each other; public headers (include/abbe) include no internal ones (src/abbe), and nobody but
their own library, tests, fuzzers and benchmarks includes internal headers; only `formats`, `report` and the programs
(`apps`, `papers`, `step`) touch files; `src` and `apps` include nothing from `papers` and `step`; headers have
`#pragma once`; nothing is included twice; no file is longer than MAX_LINES, and all of `apps` than APPS_LINES, since
libraries do the work; no folder has a name that says nothing; no two headers of the library declare a type of one name;
pages come from web/src/template.html, which holds the content security policy, or hold one themselves. Every violation
is one line: file:line: message.
"""
import os
import re
import sys

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from violations_report import report  # noqa: E402

ORDER = ["geometry", "machine", "errors", "instruments", "identify", "plan", "compensate", "verify", "formats",
         "report", "controls", "runtime", "study", "history"]
STRANGERS = {("identify", "compensate"), ("compensate", "identify")}
TOUCH_FILES = {"formats", "report", "history"}
FILE_HEADERS = {"fstream", "cstdio", "stdio.h", "filesystem", "fcntl.h", "unistd.h", "sys/stat.h", "sys/mman.h"}
MEANINGLESS = {"util", "utils", "common", "core", "helper", "helpers", "misc", "manager", "managers"}
MAX_LINES = 500
APPS_LINES = 7000
PLACES = ["include", "src", "apps", "papers", "step", "linuxcnc", "tests", "fuzz", "benchmarks", "python", "web", "cmake", ".ci"]
OTHER_PROGRAMS = ("papers", "step")
# They may include internal headers of any library; linuxcnc compiles sources of the runtime.
INSIDERS = {"tests", "fuzz", "benchmarks", "linuxcnc"}
SOURCES = (".h", ".cpp", ".py", ".ts", ".js", ".mjs", ".css", ".cmake")
SKIP = {"node_modules", "build", "dist", "__pycache__"}
PAGE = re.compile(r"<!doctype html|<html[ >]", re.IGNORECASE)
POLICY = '<meta http-equiv="Content-Security-Policy"'
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')


def files_below(root, place):
    for folder, names, files in os.walk(os.path.join(root, place)):
        names[:] = sorted(n for n in names if n not in SKIP and not n.startswith("build"))
        yield os.path.relpath(folder, root).replace(os.sep, "/"), sorted(files)


def check_library_include(folder, target, is_test):
    """What is wrong with a file of src/abbe/<folder> including `target`, or nothing."""
    if target.startswith("abbe/"):
        other = target.split("/")[1]
        if other not in ORDER:
            return f"'{target}' is in no folder of the order {' '.join(ORDER)}"
        if (folder, other) in STRANGERS:
            return f"'{folder}' and '{other}' do not see each other"
        if ORDER.index(other) > ORDER.index(folder):
            return f"'{folder}' includes '{target}', which is below it"
    elif target in FILE_HEADERS and folder not in TOUCH_FILES and not is_test:
        return f"<{target}>: only {' and '.join(sorted(TOUCH_FILES))} touch files"
    return None


def check_internal_include(root, path, target, is_test):
    """What is wrong with `path` including `target` of the library, or nothing."""
    if not target.startswith("abbe/") or os.path.exists(os.path.join(root, "include", target)):
        return None
    if not os.path.exists(os.path.join(root, "src", target)):
        return f"'{target}' does not exist"
    parts = path.split("/")
    if parts[0] == "include":
        return f"'{target}' is internal, and this header is public"
    if parts[0] in INSIDERS or is_test or parts[:3] == ["src", "abbe", target.split("/")[1]]:
        return None
    return f"'{target}' is internal to '{target.split('/')[1]}'"


def other_program(root, path, target):
    """`papers` or `step` if a file of src/ or apps/ that includes `target` means one from there, or nothing."""
    beside = os.path.normpath(os.path.join(os.path.dirname(path), target)).replace(os.sep, "/")
    for meant in (beside, f"apps/{target}", *(f"{program}/{target}" for program in OTHER_PROGRAMS), target):
        if os.path.exists(os.path.join(root, meant)):
            place = meant.split("/")[0]
            return place if place in OTHER_PROGRAMS else None
    return None


def check_cpp(root, path, text):
    parts = path.split("/")
    folder = parts[2] if parts[0] in ("include", "src") and parts[1] == "abbe" and len(parts) > 3 else None
    is_test = path.endswith(("_test.cpp", "_for_test.h", "_for_test.cpp"))
    seen = {}
    guarded = False
    for number, line in enumerate(text.splitlines(), 1):
        if line.strip() == "#pragma once":
            guarded = True
        match = INCLUDE.match(line)
        if not match:
            # The same file may be included again in the other branch of a condition.
            if line.lstrip().startswith("#") and not line.startswith("#pragma"):
                seen.clear()
            continue
        quote, target = match.groups()
        if target in seen:
            yield number, f"'{target}' is included twice (line {seen[target]})"
        seen[target] = number
        program = other_program(root, path, target) if parts[0] in ("include", "src", "apps") else None
        if program:
            yield number, f"'{target}': '{parts[0]}' does without '{program}'"
        problem = check_internal_include(root, path, target, is_test)
        if problem:
            yield number, problem
        if folder is None:
            continue
        if quote == '"' and os.path.exists(os.path.join(root, os.path.dirname(path), target)):
            yield number, f"'{target}': write the path from abbe/"
        problem = check_library_include(folder, target, is_test)
        if problem:
            yield number, problem
    # Highway compiles some headers once per processor; those have its own guard.
    if path.endswith(".h") and not guarded and "HWY_TARGET_TOGGLE" not in text:
        yield 1, "header without #pragma once"


TYPE = re.compile(r"^(?:struct|class|enum class) (\w+)(?: final)?(?: : [^;]*)?\s*(?:\{|$)")


def repeated_types(root):
    """Types of one name in two headers of the library: one namespace, so each must have a name of its own."""
    where = {}
    for folder, files in [*files_below(root, "include"), *files_below(root, "src")]:
        for name in files:
            if not name.endswith(".h") or name.endswith("_for_test.h"):
                continue
            path = f"{folder}/{name}"
            with open(os.path.join(root, path), encoding="utf-8") as stream:
                for number, line in enumerate(stream, 1):
                    match = TYPE.match(line.rstrip())
                    if match and match.group(1) in where and where[match.group(1)] != path:
                        yield path, number, f"'{match.group(1)}' is also in {where[match.group(1)]}"
                    elif match:
                        where[match.group(1)] = path


def check_page(path, text):
    """A page from elsewhere than the template states its own content security policy beside its beginning."""
    if POLICY in text.replace('\\"', '"'):
        return
    if path.endswith(("_test.cpp", "_test.py")) or path.startswith("tests/"):
        return
    for number, line in enumerate(text.splitlines(), 1):
        if PAGE.search(line):
            yield number, "a page of its own without a content security policy; pages come from web/src/template.html"


def violations(root):
    """All violations as (path, line, message)."""
    for library in ("include/abbe", "src/abbe"):
        folders = os.path.join(root, library)
        for name in sorted(os.listdir(folders)) if os.path.isdir(folders) else []:
            if os.path.isdir(os.path.join(folders, name)) and name not in ORDER:
                yield f"{library}/{name}", 1, f"folder is not in the order {' '.join(ORDER)}"
    yield from repeated_types(root)
    template = os.path.join(root, "web", "src", "template.html")
    if os.path.exists(template):
        with open(template, encoding="utf-8") as stream:
            if POLICY not in stream.read():
                yield "web/src/template.html", 1, "no content security policy"
    apps = 0
    for place in PLACES:
        for folder, files in files_below(root, place):
            if os.path.basename(folder).lower() in MEANINGLESS:
                yield folder, 1, "a folder's name says what is in it"
            for name in files:
                if not name.endswith(SOURCES) and name != "CMakeLists.txt":
                    continue
                path = f"{folder}/{name}"
                with open(os.path.join(root, path), encoding="utf-8") as stream:
                    text = stream.read()
                lines = text.count("\n")
                if lines > MAX_LINES:
                    yield path, MAX_LINES, f"{lines} lines; at most {MAX_LINES}"
                apps += lines if place == "apps" and name.endswith((".h", ".cpp")) else 0
                for number, message in check_page(path, text):
                    yield path, number, message
                if name.endswith((".h", ".cpp")):
                    for number, message in check_cpp(root, path, text):
                        yield path, number, message
    if apps > APPS_LINES:
        yield "apps", 1, f"{apps} lines; at most {APPS_LINES}"


if __name__ == "__main__":
    sys.exit(report("structure", __doc__, violations))
