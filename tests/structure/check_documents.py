#!/usr/bin/env python3
"""Check that what documents name in the source tree exists. Usage: check_documents.py ROOT

In every *.md but CHANGELOG.md, which tells of the past: a path in code (between back-ticks or in a block) that begins with
a folder of the source tree exists; so does "abbe/LIBRARY/x.h" below include/ or src/; so does a file named between
back-ticks alone, "x.h" or "x.cpp", anywhere. `*` stands for any text, and a word in capitals for a name. The table of
docs/architecture.md names one header for each library, which exists and is among those whose examples are run
(tests/header_examples); the headers that these name in their first comment exist, "x.h" somewhere in their library,
"room/x.h" there. Every violation is one line: file:line: message.

Prose has at most 120 columns, but for tables, blocks and lines without a blank; documents of golden files are left out.
"""
import glob
import os
import re
import sys

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "header_examples"))
from check_structure import ORDER, files_below  # noqa: E402
from violations_report import report  # noqa: E402
from write_examples import first_comment  # noqa: E402

FOLDERS = ["src", "include", "apps", "papers", "step", "tests", "fuzz", "benchmarks", "cmake", "examples", "docs",
           "web", "linuxcnc", "packaging", "abbe"]
PATH = re.compile(r"(?<![\w./~$*-])(?:" + "|".join(FOLDERS) + r")/[\w./*-]*\w\*?")
FILE = re.compile(r"(?<![\w./*-])[\w*-]+\.(?:h|cpp)(?![\w.])")
HEADER = re.compile(r"[\w-]+(?:/[\w-]+)*\.h\b(?!>)")
CODE = re.compile(r"`([^`]+)`")
PLACEHOLDER = re.compile(r"(?<![A-Za-z])[A-Z]{3,}(?![A-Za-z])")
ROW = re.compile(r"^\| `(\w+)` \|.*\| ([^|]*) \|$")
COLUMNS = 120
ARCHITECTURE = "docs/architecture.md"
EXAMPLES = "tests/header_examples/CMakeLists.txt"


def code_in(text):
    """What stands in code: (line, code, whether in a block)."""
    block = False
    for number, line in enumerate(text.splitlines(), 1):
        if line.lstrip().startswith("```"):
            block = not block
        elif block:
            yield number, line, True
        else:
            for code in CODE.findall(line):
                yield number, code, False


def exists(root, path):
    pattern = PLACEHOLDER.sub("*", path)
    if path.startswith("abbe/"):
        # The command is called abbe too: only headers of the library are meant.
        places = [os.path.join(root, place, pattern) for place in ("include", "src")]
        return not path.endswith(".h") or any(glob.glob(place) for place in places)
    # A program may be named for its source.
    return any(glob.glob(os.path.join(root, pattern + ending)) for ending in ("", ".cpp"))


def missing_paths(root, text, names):
    for number, code, block in code_in(text):
        for path in PATH.findall(code):
            if not exists(root, path):
                yield number, f"'{path}' does not exist"
        for name in FILE.findall(code) if not block else []:
            pattern = re.compile(re.escape(PLACEHOLDER.sub("*", name)).replace(r"\*", ".*"))
            if not any(pattern.fullmatch(each) for each in names):
                yield number, f"no file is called '{name}'"


def long_lines(text):
    block = False
    for number, line in enumerate(text.splitlines(), 1):
        start = line.lstrip()
        if start.startswith("```"):
            block = not block
        elif len(line) > COLUMNS and not block and not line.startswith("    ") and start[:1] != "|" and " " in start:
            yield number, f"{len(line)} columns, expected at most {COLUMNS}"


def wrong_lead_headers(root, text):
    """The table of libraries: one header for each, in their order."""
    rows = [(number, *match.groups()) for number, line in enumerate(text.splitlines(), 1)
            if (match := ROW.match(line)) and match.group(1) in ORDER]
    if [library for _, library, _ in rows] != ORDER:
        yield 1, f"expected a table of the libraries {' '.join(ORDER)}"
    run = examples(root)
    for number, library, cell in rows:
        headers = CODE.findall(cell)
        if len(headers) != 1:
            yield number, f"'{library}': expected one header to open first, found {len(headers)}"
        elif f"{library}/{headers[0]}" not in run:
            yield number, f"'{library}/{headers[0]}' is not among the examples of {EXAMPLES}"


def missing_headers(root, path):
    """Headers that the first comment of the header `path` names and that do not exist."""
    library = os.path.join(root, "include", *path.split("/")[:2])
    known = {os.path.relpath(f"{folder}/{name}", library) for folder, _, names in os.walk(library) for name in names}
    known |= {os.path.basename(each) for each in known}
    with open(os.path.join(root, "include", path), encoding="utf-8") as stream:
        comment = first_comment(stream.read())
    for number, line in comment:
        for header in HEADER.findall(line):
            if header not in known and not os.path.exists(os.path.join(root, "include", header)):
                yield number, f"no header is called '{header}'"


def examples(root):
    """Headers that begin with an example: "machine/machine.h"."""
    with open(os.path.join(root, EXAMPLES), encoding="utf-8") as stream:
        return set(re.findall(r"^\s*(\w+/[\w/]+\.h)", stream.read(), re.MULTILINE))


def violations(root):
    documents, names = [], set()
    for folder, files in files_below(root, "."):
        if folder.startswith(".git"):
            continue
        names.update(files)
        documents += [os.path.normpath(f"{folder}/{name}") for name in files
                      if name.endswith(".md") and name != "CHANGELOG.md"]
    for path in documents:
        with open(os.path.join(root, path), encoding="utf-8") as stream:
            text = stream.read()
        for number, message in missing_paths(root, text, names):
            yield path, number, message
        for number, message in long_lines(text) if not path.startswith("tests/golden/") else []:
            yield path, number, message
        if path == ARCHITECTURE:
            for number, message in wrong_lead_headers(root, text):
                yield path, number, message
    for header in sorted(examples(root)):
        for number, message in missing_headers(root, f"abbe/{header}"):
            yield f"include/abbe/{header}", number, message


if __name__ == "__main__":
    sys.exit(report("documents", __doc__, violations))
