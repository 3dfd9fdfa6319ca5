"""Reference of the Python package, a page for each group of names (python_groups.py), as reStructuredText."""

import ast
import pathlib
import re

from python_groups import Group, groups
from python_source import SPECIAL, Name, module_names, public_names
from stage import Stage

DIRECTIVES = {
    "class": "class",
    "exception": "exception",
    "function": "function",
    "data": "data",
    "method": "method",
    "property": "property",
}
DOCUMENT = re.compile(r"(?<![\w/])docs/([\w-]+)\.md")
IN_CODE = re.compile(r"``?abbe\.(\w+)``?")
SPANS = re.compile(r"(``.+?``|(?::[\w:]+:)?`[^`]+`)", re.DOTALL)
# What is plain text in a docstring and markup for Sphinx: a product, an absolute value, a name that ends in a line.
MARKUP = re.compile(r"[*|]|_(?!\w)")
PARTS = ["Results hold objects of these types. They cannot be constructed, so `abbe` does not export their names."]


def heading(text: str, line: str) -> list[str]:
    return [text, line * len(text), ""]


def indented(lines: list[str]) -> list[str]:
    return [f"   {line}" if line else "" for line in lines]


class Qualify(ast.NodeTransformer):
    """Names of the package in types with their modules."""

    def __init__(self, names: dict[str, Name]) -> None:
        self.names = names

    def visit_Name(self, node: ast.Name) -> ast.expr:
        if node.id in self.names:
            module = "abbe" if self.names[node.id].exported else "abbe._core"
        else:
            return node
        return ast.Attribute(ast.parse(module, mode="eval").body, node.id, ast.Load())


class Pages:
    """Writes what is known of names as reStructuredText."""

    def __init__(self, root: pathlib.Path, names: dict[str, Name]) -> None:
        self.root, self.names = root, names
        self.qualify = Qualify(names)

    def type(self, text: str) -> str:
        """A type as Sphinx finds its names; it shows them without their module."""
        return ast.unparse(self.qualify.visit(ast.parse(text, mode="eval").body))

    def signature(self, text: str) -> str:
        """A signature with such types."""
        function = ast.parse(f"def f{text}: ...").body[0]
        assert isinstance(function, ast.FunctionDef)
        for node in ast.walk(function.args):
            if isinstance(node, ast.arg) and node.annotation is not None:
                node.annotation = self.qualify.visit(node.annotation)
        if function.returns is not None:
            function.returns = self.qualify.visit(function.returns)
        return ast.unparse(function).removeprefix("def f").partition(":\n")[0]

    def text(self, doc: str) -> str:
        """A docstring as Sphinx reads it, with links to the documents and names that it speaks of."""

        def document(match: re.Match[str]) -> str:
            page = self.root / f"docs/{match[1]}.md"
            return f":doc:`docs/{match[1]}.md </docs/{match[1]}>`" if page.exists() else match[0]

        def part(text: str) -> str:
            if text.startswith(("`", ":")):
                name = IN_CODE.fullmatch(text)
                return f":py:obj:`abbe.{name[1]}`" if name and name[1] in self.names else text
            return DOCUMENT.sub(document, MARKUP.sub(r"\\\g<0>", text))

        def paragraph(text: str) -> str:
            return text if text.startswith(">>>") else "".join(map(part, SPANS.split(text)))

        return "\n\n".join(map(paragraph, doc.split("\n\n")))

    def entry(self, one: Name) -> list[str]:
        """The directive of a name, with its members."""
        lines, first = [], f".. py:{DIRECTIVES[one.kind]}:: "
        for number, signature in enumerate(one.signatures or [""]):
            lines.append(
                (first if number == 0 else " " * len(first))
                + one.name
                + (self.signature(signature) if signature else "")
            )
        lines += [f"   :{flag}:" for flag in one.flags if flag != "settable"]
        lines += [f"   :type: {self.type(one.type)}"] if one.type else []
        body = [""]
        bases = [base for base in one.bases if base != "object"]
        if bases:
            body += ["Base: " + ", ".join(f"``{base}``" for base in bases) + ".", ""]
        body += self.text(one.doc).splitlines() + [""]
        if "settable" in one.flags:
            body += ["Can be set.", ""]
        for member in sorted(one.members, key=lambda member: member.name in SPECIAL):
            body += self.entry(member)
        return [*lines, *indented(body), ""]

    def summary(self, name: str, one: Name, module: str) -> list[str]:
        """A row of a table: the name and its first sentence."""
        paragraph = " ".join(self.text(one.doc).partition("\n\n")[0].split())
        sentence = re.split(r"\. (?=[A-Z:`])", paragraph, maxsplit=1)[0].rstrip(".:")
        return [f"   * - :py:obj:`~{module}.{name}`", f"     - {sentence}"]

    def table(self, names: dict[str, Name], module: str) -> list[str]:
        rows = [line for name, one in names.items() for line in self.summary(name, one, module)]
        return [".. list-table::", "   :class: names", "", *rows, ""]


def page_name(group: Group) -> str:
    return re.sub(r"[^a-z0-9]+", "-", (group.listed[0] if group.listed else "other").lower()).strip("-")


def title(group: Group) -> str:
    more = " and more" if len(group.listed) > 3 else ""
    return ", ".join(group.listed[:3]) + more if group.listed else "Other names"


def write(stage: Stage, package: pathlib.Path) -> None:
    names = public_names(package)
    pages = Pages(stage.root, names)
    index = [
        *heading("Python reference", "="),
        ".. py:module:: abbe",
        "",
        "All public names of the package ``abbe``, by task. :doc:`/docs/python` tells how they work together.",
        "",
    ]
    order = []
    for group in groups(stage.root / "docs/python.md", names):
        here = {name: names[name] for name in group.names if names[name].exported}
        parts = {name: names[name] for name in group.names if not names[name].exported}
        module, about = "abbe", group.about[0].upper() + group.about[1:]
        lines = [*heading(title(group), "=")]
        words = about + "."
        if not here:
            module = group.listed[0]
            here = module_names(package / f"{module.removeprefix('abbe.')}.py")
            lines += [f".. py:module:: {module}", "", *pages.text(here.pop("__doc__").doc).splitlines(), ""]
        else:
            lines += [".. py:currentmodule:: abbe", "", words, ""]
        if group.headers:
            lines += ["In C++: " + ", ".join(f"``{header}``" for header in group.headers) + ".", ""]
        if len(here) > 1:
            lines += pages.table(here, module)
        for one in here.values():
            lines += pages.entry(one)
        if parts:
            lines += [*heading("Parts of results", "-"), ".. py:currentmodule:: abbe._core", "", *PARTS, ""]
            lines += pages.table(parts, "abbe._core")
            for one in parts.values():
                lines += pages.entry(one)
        order.append(page_name(group))
        stage.write(f"reference/python/{order[-1]}.rst", "\n".join(lines))
        index += [*heading(title(group), "-"), words, "", *pages.table(here, module)]
    index += [".. toctree::", "   :hidden:", "", *(f"   {name}" for name in order), ""]
    stage.write("reference/python/index.rst", "\n".join(index))
