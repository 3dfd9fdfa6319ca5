#!/usr/bin/env python3
"""Check the links of a folder of pages. Usage: check_links.py FOLDER

Every link, image, style and script leads to a file of the folder and, with #anchor, to an element that has this id.
Links to other hosts are checked for their form only, nothing is fetched; a page loads nothing from other hosts. Every
page but the search page can be reached from index.html. Every fault is one line: page: message.
"""

import html.parser
import pathlib
import sys
import urllib.parse
from collections.abc import Iterator

# What a browser loads by itself when it shows the element.
LOADS = {
    ("img", "src"),
    ("script", "src"),
    ("link", "href"),
    ("source", "src"),
    ("source", "srcset"),
    ("iframe", "src"),
    ("video", "src"),
    ("audio", "src"),
    ("object", "data"),
    ("embed", "src"),
    ("use", "href"),
}
FOLLOWS = {("a", "href"), ("area", "href"), ("form", "action")}
# `link` elements that only name a page.
NAMES = {"next", "prev", "index", "search", "author", "copyright", "canonical"}
UNLINKED = {"search.html"}


class Page(html.parser.HTMLParser):
    """The ids and links of a page."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.ids: set[str] = set()
        self.repeated: set[str] = set()
        self.links: list[tuple[bool, str]] = []  # (whether it is loaded, target)
        self.feed(text)

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        values = dict(attributes)
        name = values.get("id")
        if name:
            (self.repeated if name in self.ids else self.ids).add(name)
        if tag == "a" and values.get("name"):
            self.ids.add(values["name"] or "")
        for attribute, value in attributes:
            if value is not None and (tag, attribute) in LOADS | FOLLOWS:
                loaded = (tag, attribute) in LOADS and values.get("rel") not in NAMES
                self.links.append((loaded, value))


def fault_of_host(link: urllib.parse.SplitResult) -> str | None:
    """What is wrong with a link to another host, or nothing."""
    if link.scheme == "mailto":
        return None if "@" in link.path else "expected an address"
    if link.scheme not in ("http", "https"):
        return "expected http, https, mailto or a path"
    try:
        port = link.port
    except ValueError:
        return "the port is no number"
    if not link.hostname or "." not in link.hostname or port == 0:
        return "expected the name of a host"
    return None


def faults(folder: pathlib.Path) -> Iterator[tuple[str, str]]:
    """(page, what is wrong)."""
    folder = folder.resolve()
    pages = {path: Page(path.read_text(encoding="utf-8")) for path in sorted(folder.rglob("*.html"))}
    reached: dict[pathlib.Path, set[pathlib.Path]] = {}
    for path, page in pages.items():
        name = path.relative_to(folder).as_posix()
        for repeated in sorted(page.repeated):
            yield name, f"two elements have the id '{repeated}'"
        for loaded, text in page.links:
            link = urllib.parse.urlsplit(text)
            if any(letter.isspace() for letter in text.strip()) and not text.startswith("data:"):
                yield name, f"'{text}': white space in a link"
            elif loaded and link.scheme == "data":
                continue
            elif link.scheme or link.netloc:
                if loaded:
                    yield name, f"'{text}': loaded from another host"
                elif problem := fault_of_host(link):
                    yield name, f"'{text}': {problem}"
            elif link.path.startswith("/"):
                yield name, f"'{text}': expected a path relative to the page"
            else:
                there = (path.parent / urllib.parse.unquote(link.path)).resolve() if link.path else path
                if not there.is_file() or not there.is_relative_to(folder):
                    yield name, f"'{text}': there is no such file"
                    continue
                reached.setdefault(path, set()).add(there)
                anchor = urllib.parse.unquote(link.fragment)
                if anchor and there in pages and anchor not in pages[there].ids:
                    yield name, f"'{text}': there is no element with this id"
    known, left = set(), [folder / "index.html"]
    while left:
        path = left.pop()
        if path not in known:
            known.add(path)
            left += reached.get(path, ())
    for path in pages:
        name = path.relative_to(folder).as_posix()
        if path not in known and name not in UNLINKED:
            yield name, "no link leads to this page"


def main() -> int:
    if len(sys.argv) != 2:
        print(__doc__, file=sys.stderr)
        return 2
    found = list(faults(pathlib.Path(sys.argv[1])))
    for page, message in found:
        print(f"{page}: {message}")
    print(f"links: {len(found)} faults")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
