"""Pages of the public C++ headers: a page for each library, with the examples that the tests run and what every header
says first. The libraries and the header of each to open first are those of the table in docs/architecture.md."""

import pathlib
import re
import sys

from stage import Stage, toctree

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tests/structure"), str(ROOT / "tests/header_examples")]
from check_documents import examples  # noqa: E402
from check_headers import TYPE, without_comments  # noqa: E402
from write_examples import PRINTS, first_comment, indented, is_c  # noqa: E402

ROW = re.compile(r"^\| `(\w+)` \| (.*) \| `([\w/]+\.h)` \|$", re.MULTILINE)
DOC = re.compile(r"^///? ?(.*)$")
INTRODUCTION = """# C++ libraries

A program includes the headers of `include/abbe` and links the libraries it uses, `abbe::study` or `abbe::identify`
(`find_package(abbe)`). [Architecture](../../docs/architecture.md) says how they fit together. Each page begins with a
complete program: the tests compile and run it.

| library | what it holds | open this header first |
|---|---|---|
"""


def example_part(path: str, text: str) -> str:
    """The first comment of a header that begins with an example, as a section."""
    comment = first_comment(text)
    program = indented(comment, 1)
    last = program[-1][0]
    where = next(i for i, (number, line) in enumerate(comment) if number > last and line == PRINTS)
    printed = indented(comment, where + 1)
    overview = [line.removeprefix("//").removeprefix(" ") for number, line in comment if number > printed[-1][0]]
    overview = "\n".join(overview).strip("\n").split("\n")
    title = comment[0][1].removeprefix("// ").rstrip(":")
    lines = [
        f"## {title}",
        "",
        f"`{path}` begins with this program:",
        "",
        f"```{'c' if is_c(program) else 'cpp'}",
        *(line for _, line in program),
        "```",
        "",
        "It prints:",
        "",
        "```text",
        *(line for _, line in printed),
        "```",
        "",
    ]
    if overview[0]:
        lines += [overview[0], ""]
        if overview[1:]:
            lines += ["```text", *(line.removeprefix("  ") for line in overview[1:]), "```", ""]
    return "\n".join(lines)


def first_sentence(text: str) -> str:
    """What the first comment that is not an example says first."""
    lines = text.splitlines()
    skipped = {number for number, _ in first_comment(text)} if PRINTS in text else set()
    said: list[str] = []
    for number, line in enumerate(lines, 1):
        match = DOC.match(line) if number not in skipped else None
        if match and match.group(1):
            said.append(match.group(1))
        elif said:
            break
    sentence = re.split(r"(?<=[^.]\w)[.:;] |[.:;]$|@param|@returns", " ".join(said), maxsplit=1)[0].strip()
    return re.sub(r"([\\`*_|<>$\[\]])", r"\\\1", sentence)


def library_page(library: str, holds: str, lead: str, with_example: set[str]) -> str:
    folder = ROOT / "include/abbe" / library
    headers = {
        path.relative_to(ROOT / "include").as_posix(): path.read_text(encoding="utf-8")
        for path in sorted(folder.rglob("*.h"))
    }
    first = [f"abbe/{library}/{lead}"]
    first += [path for path in headers if path.removeprefix("abbe/") in with_example and path not in first]
    parts = [f"# C++: {library}\n\n{holds[0].upper()}{holds[1:]}.\n"]
    parts += [example_part(path, headers[path]) for path in first]
    rows = [
        "## Headers",
        "",
        f"In `include/abbe/{library}`:",
        "",
        "| header | what it begins with | types |",
        "|---|---|---|",
    ]
    for path, text in headers.items():
        types = {match.group(1) or match.group(2): None for match in TYPE.finditer(without_comments(text))}
        name = path.removeprefix(f"abbe/{library}/")
        rows.append(f"| `{name}` | {first_sentence(text)} | {', '.join(f'`{each}`' for each in types)} |")
    return "\n".join([*parts, *rows, ""])


def write(stage: Stage) -> None:
    with_example = examples(str(ROOT))
    table = ROW.findall((ROOT / "docs/architecture.md").read_text(encoding="utf-8"))
    libraries = [row for row in table if (ROOT / "include/abbe" / row[0]).is_dir()]
    index = INTRODUCTION
    for library, holds, lead in libraries:
        index += f"| [{library}]({library}.md) | {holds} | `abbe/{library}/{lead}` |\n"
        stage.write(f"reference/cpp/{library}.md", library_page(library, holds, lead, with_example))
    pages = [f"reference/cpp/{library}" for library, _, _ in libraries]
    stage.write("reference/cpp/index.md", f"{index}\n{toctree(['/' + page for page in pages], 'C++ libraries')}")
