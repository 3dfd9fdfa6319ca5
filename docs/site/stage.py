"""Copies of the documents in the form that Sphinx reads: README.md of a folder is its index page, and the table of
pages in docs/README.md is the navigation. The documents themselves stay as a forge shows them."""

import pathlib
import re
from collections.abc import Iterator

PAGES = [
    "README.md",
    "CHANGELOG.md",
    "CONTRIBUTING.md",
    "docs/*.md",
    "examples/*/README.md",
    "linuxcnc/README.md",
    "python/notebooks/*.ipynb",
]
IMAGES = ["docs/images/*"]
LINK = re.compile(r"\[([^\[\]]+)\]\(([^()\s]+)\)")
FENCE = re.compile(r"^ *```")
HEADING = re.compile(r"^## (.+)$")
HOST = re.compile(r"^[a-z]+:")


def put(path: pathlib.Path, content: bytes) -> None:
    """Writes only what is new, so that Sphinx reads again only what has changed."""
    if not path.exists() or path.read_bytes() != content:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)


def blocks(text: str) -> Iterator[tuple[bool, str]]:
    """The text in parts: (whether it is a block of code, its lines)."""
    code, lines = False, []
    for line in text.splitlines(keepends=True):
        if FENCE.match(line):
            if not code:
                yield False, "".join(lines)
                lines = []
            lines.append(line)
            if code:
                yield True, "".join(lines)
                lines = []
            code = not code
        else:
            lines.append(line)
    yield code, "".join(lines)


def page_of(path: str) -> str:
    """Where a document is in the site: README.md is the index of its folder."""
    return re.sub(r"(^|/)README\.md$", r"\1index.md", path)


class Stage:
    """A folder with all that Sphinx reads."""

    def __init__(self, root: pathlib.Path, folder: pathlib.Path) -> None:
        self.root, self.folder = root, folder
        self.written: set[pathlib.Path] = set()

    def write(self, name: str, text: str | bytes) -> None:
        path = self.folder / name
        put(path, text.encode() if isinstance(text, str) else text)
        self.written.add(path)

    def copy_documents(self) -> None:
        for pattern in PAGES + IMAGES:
            for path in sorted(self.root.glob(pattern)):
                name = path.relative_to(self.root).as_posix()
                if path.suffix != ".md":
                    self.write(name, path.read_bytes())
                    continue
                text = self.adapted(name, path.read_text(encoding="utf-8"))
                self.write(page_of(name), text + (self.navigation() if name == "README.md" else ""))

    def remove_others(self) -> None:
        """What an earlier run has left."""
        for path in sorted(self.folder.rglob("*"), reverse=True):
            if path.is_file() and path not in self.written:
                path.unlink()
            elif path.is_dir() and not any(path.iterdir()):
                path.rmdir()

    def adapted(self, name: str, text: str) -> str:
        """The document with its links as those of the site."""
        here = (self.root / name).parent

        def link(match: re.Match[str]) -> str:
            label, target = match.groups()
            if HOST.match(target) or target.startswith("#"):
                return match.group()
            path, _, anchor = target.partition("#")
            there = (here / path).resolve()
            if there.is_dir():
                return label  # a folder is no page
            if there.is_file() and there.suffix not in (".md", ".ipynb"):
                self.write(there.relative_to(self.root).as_posix(), there.read_bytes())
            return f"[{label}]({page_of(path)}{'#' if anchor else ''}{anchor})"

        return "".join(part if code else LINK.sub(link, part) for code, part in blocks(text))

    def navigation(self) -> str:
        """The pages by task, as docs/README.md lists them; then what else there is."""
        text = (self.root / "docs/README.md").read_text(encoding="utf-8")
        sections: dict[str, list[str]] = {"Begin here": ["docs/index"]}
        caption = "Begin here"
        for line in text.splitlines():
            if heading := HEADING.match(line):
                caption = heading.group(1)
                sections[caption] = []
            for _, target in LINK.findall(line):
                page = (self.root / "docs" / target).resolve().relative_to(self.root)
                sections[caption].append(page.with_suffix("").as_posix())
        notebooks = sorted(self.root.glob("python/notebooks/*.ipynb"))
        python = ["docs/python", "reference/python/index", *(f"python/notebooks/{path.stem}" for path in notebooks)]
        sections = {caption: [page for page in pages if page not in python] for caption, pages in sections.items()}
        last = list(sections)[-1]
        work = sections.pop(last)
        sections["Python"] = python
        sections["Examples"] = [
            f"examples/{path.parent.name}/index" for path in sorted(self.root.glob("examples/*/README.md"))
        ]
        sections["Examples"].append("linuxcnc/index")
        sections[last] = [*work, "reference/cpp/index", "CHANGELOG"]
        return "\n" + "\n".join(toctree(pages, caption) for caption, pages in sections.items())


def toctree(pages: list[str], caption: str) -> str:
    return "\n".join(["```{toctree}", ":hidden:", f":caption: {caption}", "", *pages, "```", ""])
