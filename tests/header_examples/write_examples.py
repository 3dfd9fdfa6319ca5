#!/usr/bin/env python3
"""Turn examples at the beginning of public headers into sources. Usage: write_examples.py ROOT OUT HEADER=LIBRARIES ...

HEADER is a path below ROOT/include/abbe; LIBRARIES, with commas, are those that its example may use. The first comment
of the header holds a title, a program and what it prints:

    // What a title says:
    //
    //   #include <abbe/machine/machine.h>
    //
    //   int main() {
    //     ...
    //   }
    //
    // It prints:
    //
    //   w X' Y' b Z t

The program includes its header, and only headers of LIBRARIES and of the language; it is one function, `main`, with
at most MOST_LINES lines that are not empty, the includes among them. OUT gets a source for each header, in which the
function is called example_LIBRARY_HEADER and the lines are those of the header, and examples.inc, a line
EXAMPLE(NAME, PRINTS) for each.
A program with `int main(void)` is C.
"""
import json
import os
import re
import sys

MOST_LINES = 25
PRINTS = "// It prints:"
MAIN = re.compile(r"^int main\((void)?\) \{$")
INCLUDE = re.compile(r"^#include <(?:(abbe/(\w+)/[\w/]+\.h)|([\w./]+))>$")


class NoExample(Exception):
    """What is wrong with an example: line, message."""


def first_comment(text):
    """The lines of the first comment after the guard, without their ends: (number, line)."""
    lines = list(enumerate(text.splitlines(), 1))
    start = next((i for i, (_, line) in enumerate(lines) if line not in ("", "#pragma once")), len(lines))
    end = next((i for i in range(start, len(lines)) if not lines[i][1].startswith("//")), len(lines))
    return lines[start:end]


def indented(comment, at):
    """The indented lines from `at` on, with the empty ones between them: (number, line without its indentation)."""
    found = []
    for number, line in comment[at:]:
        if line.startswith("//   "):
            found.append((number, line[5:]))
        elif line == "//":
            found.append((number, ""))
        else:
            break
    while found and not found[-1][1]:
        found.pop()
    while found and not found[0][1]:
        found.pop(0)
    return found


def example_of(text, header, libraries):
    """Program and output of a header: [(number, line)], text. @raises NoExample"""
    comment = first_comment(text)
    program = indented(comment, 1) if comment else []
    if not program or not any(MAIN.match(line) for _, line in program):
        raise NoExample(1, "expected an example with `int main() {` in the first comment, below its title")
    first, last = program[0][0], program[-1][0]
    lines = sum(bool(line) for _, line in program)
    if lines > MOST_LINES:
        raise NoExample(last, f"{lines} lines of example; at most {MOST_LINES}")
    included = []
    for number, line in program:
        if not line.startswith("#"):
            continue
        match = INCLUDE.match(line)
        if not match:
            raise NoExample(number, f"expected '#include <...>', found '{line}'")
        included.append(match.group(1))
        if match.group(2) and match.group(2) not in libraries:
            raise NoExample(number, f"'{match.group(2)}' is none of {' '.join(libraries)}, which this library may use")
    if f"abbe/{header}" not in included:
        raise NoExample(first, f"the example does not include <abbe/{header}>")
    where = next((i for i, (number, line) in enumerate(comment) if number > last and line == PRINTS), None)
    printed = indented(comment, where + 1) if where is not None else []
    if not printed:
        raise NoExample(last, f"expected '{PRINTS}' and the output below the program")
    return program, "".join(line + "\n" for _, line in printed)


def is_c(program):
    return any((match := MAIN.match(line)) and match.group(1) for _, line in program)


def source_of(program, header, name):
    """The program as a source with a function of that name; messages of the compiler name the header."""
    main = f"int {name}(void) {{" if is_c(program) else f'extern "C" int {name}() {{'
    lines = [f"#line {program[0][0]} \"include/abbe/{header}\""]
    lines += [main if MAIN.match(line) else line for _, line in program]
    return "\n".join(lines) + "\n"


def name_of(header):
    return "example_" + re.sub(r"\W", "_", header.removesuffix(".h"))


def write(path, text):
    """Only what is new, so that nothing is compiled again that has not changed."""
    if not os.path.exists(path) or open(path, encoding="utf-8").read() != text:
        with open(path, "w", encoding="utf-8") as stream:
            stream.write(text)


def main():
    if len(sys.argv) < 4:
        print(__doc__, file=sys.stderr)
        return 2
    root, out, wanted = sys.argv[1], sys.argv[2], sys.argv[3:]
    table, wrong = "", 0
    for header, _, libraries in (each.partition("=") for each in wanted):
        name = name_of(header)
        with open(os.path.join(root, "include", "abbe", header), encoding="utf-8") as stream:
            text = stream.read()
        try:
            program, printed = example_of(text, header, libraries.split(","))
        except NoExample as problem:
            print(f"include/abbe/{header}:{problem.args[0]}: {problem.args[1]}", file=sys.stderr)
            wrong += 1
            continue
        suffix = ".c" if is_c(program) else ".cpp"
        write(os.path.join(out, name + suffix), source_of(program, header, name))
        table += f"EXAMPLE({name.removeprefix('example_')}, {json.dumps(printed)})\n"
    write(os.path.join(out, "examples.inc"), table)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
