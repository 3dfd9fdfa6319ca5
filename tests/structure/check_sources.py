#!/usr/bin/env python3
"""Check that the sources of one library can be compiled together. Usage: check_sources.py ROOT

A build compiles the sources of a library in batches (cmake/AbbeUnits.cmake), and the sizes of the batches differ between
builds. Two sources whose anonymous namespaces have the same name in them may so be joined in one build and not in another.
Hence no constant, type or function with the same parameters at the start of a line has one name in two sources of a
library, or that of a constant or type of a public header which the library may include. Every violation is one line:
file:line: message.
"""
import os
import re
import sys

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from check_structure import OTHER_PROGRAMS, ORDER, TYPE, files_below  # noqa: E402
from violations_report import report  # noqa: E402

CONSTANT = re.compile(r"^(?:inline |static )?(?:constexpr|const) [\w:<>, *&]+?[ *](\w+)(?:\[[^\]]*\])*\s*(?:=|\{|$)")
FUNCTION = re.compile(r"^[A-Za-z][\w:<>,*& ]*?[ *&](\w+)\(((?:[^;{}()]|\([^()]*\))*)\)(?: noexcept)? \{", re.MULTILINE)

ADDRESS = re.compile(r"[(,] ?&(\w+)[,)]")


def parameters(text):
    """Types of the parameters of a function, without names and default values."""
    depth, one, all_of_them = 0, "", []
    for letter in text + ",":
        depth += (letter in "<([") - (letter in ">)]")
        if letter == "," and not depth:
            all_of_them.append(re.sub(r"\s*\b\w+$", "", " ".join(one.split("=")[0].split())))
            one = ""
        else:
            one += letter
    return ", ".join(all_of_them)


def names_in(text):
    """(line, name) of the constants, types and functions that `text` defines at the start of a line."""
    for number, line in enumerate(text.splitlines(), 1):
        match = CONSTANT.match(line) or TYPE.match(line)
        if match:
            yield number, match.group(1)
    for match in FUNCTION.finditer(text):
        yield text.count("\n", 0, match.start()) + 1, f"{match.group(1)}({parameters(match.group(2))})"


def read(root, path):
    with open(os.path.join(root, path), encoding="utf-8") as stream:
        return stream.read()


def paths_below(root, place, ending):
    for folder, files in files_below(root, place):
        for name in files:
            if name.endswith(ending) and not name.endswith(("_test.cpp", "_for_test.cpp", "_for_test.h")):
                yield f"{folder}/{name}"


def violations(root):
    """All violations as (path, line, message)."""
    public = {}
    for library in [*(f"src/abbe/{name}" for name in ORDER), "apps", *OTHER_PROGRAMS, "python/bindings"]:
        # In the order of the libraries: those before are the ones that this may include.
        for path in paths_below(root, library.replace("src/", "include/", 1), ".h") if library.startswith("src/") else ():
            public.update((name, path) for _, name in names_in(read(root, path)) if "(" not in name)
        own = {}
        addressed = set()
        for path in paths_below(root, library, ".cpp"):
            addressed.update(ADDRESS.findall(read(root, path)))
        for path in paths_below(root, library, ".cpp"):
            for number, name in names_in(read(root, path)):
                # The address of a function with overloads in the same unit is ambiguous.
                plain = name.split("(")[0]
                other = own.setdefault(plain if plain in addressed else name, path)
                if other != path:
                    yield path, number, f"'{name}' is also in {other}, and both may be compiled in one unit"
                elif name in public:
                    yield path, number, f"'{name}' is also in {public[name]}, which a source of the same unit may include"


if __name__ == "__main__":
    sys.exit(report("sources", __doc__, violations))
