#!/usr/bin/env python3
"""Check that public headers stand alone, without a compiler. Usage: check_headers.py ROOT

What a header of include/abbe uses of the library (types and aliases) and of the standard library (names in STANDARD) is
declared in it or in what it includes, directly or through other headers of the library. A compiler takes minutes to
look at every header alone; this takes less than a second. Every violation is one line: file:line: message.
"""
import os
import re
import sys

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from check_structure import files_below  # noqa: E402
from violations_report import report  # noqa: E402

STANDARD = {
    "algorithm": "all_of any_of clamp count fill find find_if lower_bound max max_element min min_element sort transform",
    "array": "array", "atomic": "atomic", "bitset": "bitset", "cmath": "abs asin atan2 cos hypot isfinite isnan round sin sqrt tan",
    "cstddef": "byte ptrdiff_t size_t", "cstdint": "int8_t int16_t int32_t int64_t uint8_t uint16_t uint32_t uint64_t",
    "deque": "deque", "exception": "exception exception_ptr", "filesystem": "filesystem", "fstream": "ifstream ofstream",
    "functional": "function", "initializer_list": "initializer_list", "limits": "numeric_limits", "map": "map",
    "memory": "enable_shared_from_this make_shared make_unique shared_ptr unique_ptr", "mutex": "lock_guard mutex unique_lock",
    "numbers": "numbers", "numeric": "accumulate iota", "optional": "nullopt optional", "set": "set", "span": "span",
    "stdexcept": "invalid_argument logic_error out_of_range runtime_error", "stop_token": "stop_source stop_token",
    "string": "string to_string", "string_view": "string_view", "thread": "thread", "tuple": "tie tuple",
    "type_traits": "conditional_t decay_t enable_if_t is_same_v", "unordered_map": "unordered_map",
    "utility": "exchange forward move pair swap", "variant": "get_if holds_alternative monostate variant visit", "vector": "vector"}
HEADER_OF = {name: header for header, names in STANDARD.items() for name in names.split()}
# What a header brings that the standard, or the documentation of Eigen, makes certain.
BRINGS = {"vector": {"utility", "initializer_list"}, "map": {"utility"}, "optional": {"utility"}, "string": {"string_view"},
          "memory": {"utility"}, "Eigen/Core": {"algorithm", "array", "cmath", "cstddef", "functional", "limits", "string", "utility"}}
SIZES = {"array", "cstdint", "map", "optional", "span", "string", "string_view", "vector"}  # each declares std::size_t
INCLUDE = re.compile(r'^\s*#\s*include\s*[<"]([^>"]+)[>"]', re.MULTILINE)
TYPE = re.compile(r"^(?:struct|class|enum class|enum) (\w+)(?: final)?(?: : [^;]*)?\s*(?:\{|$)|^using (\w+) =", re.MULTILINE)
FORWARD = re.compile(r"\b(?:struct|class) (\w+)")
COMMENT = re.compile(r'/\*.*?\*/|//[^\n]*|"(?:[^"\\]|\\.)*"', re.DOTALL)
WORD = re.compile(r"std::(\w+)|(?<![\w:])([A-Z]\w+)")


def without_comments(text):
    """Without comments and texts, with the lines where they were."""
    return COMMENT.sub(lambda match: "\n" * match.group().count("\n"), text)


class Headers:
    def __init__(self, root):
        self.code, self.included, self.home = {}, {}, {}
        for folder, files in files_below(root, "include"):
            for name in files:
                if not name.endswith(".h"):
                    continue
                path = f"{folder}/{name}".removeprefix("include/")
                with open(os.path.join(root, "include", path), encoding="utf-8") as stream:
                    text = stream.read()
                self.code[path] = without_comments(text)
                self.included[path] = INCLUDE.findall(text)
                for match in TYPE.finditer(self.code[path]):
                    self.home.setdefault(match.group(1) or match.group(2), set()).add(path)

    def reached(self, path):
        """The header, and what it includes directly or through headers of the library."""
        found, left = set(), [path]
        while left:
            each = left.pop()
            if each not in found:
                found.add(each)
                left += self.included.get(each, [])
        return found

    def missing(self, path):
        reached = self.reached(path)
        standard = reached | {more for header in reached for more in BRINGS.get(header, ())}
        standard |= BRINGS["Eigen/Core"] if any(header.startswith("Eigen/") for header in reached) else set()
        standard |= {"cstddef"} if standard & SIZES else set()
        forward = {name for header in reached for name in FORWARD.findall(self.code.get(header, ""))}
        told = set()
        for number, line in enumerate(self.code[path].splitlines(), 1):
            for standard_name, name in WORD.findall(line):
                if standard_name in HEADER_OF and HEADER_OF[standard_name] not in standard:
                    wanted = f"std::{standard_name}: include <{HEADER_OF[standard_name]}>"
                elif name in self.home and not self.home[name] & reached and name not in forward:
                    wanted = f"{name}: include \"{' or '.join(sorted(self.home[name]))}\""
                else:
                    continue
                if wanted not in told:
                    told.add(wanted)
                    yield number, wanted


def violations(root):
    headers = Headers(root)
    for path in sorted(headers.code):
        for number, message in headers.missing(path):
            yield f"include/{path}", number, message


if __name__ == "__main__":
    sys.exit(report("headers", __doc__, violations))
