"""The words of every page in one script, for search_excerpts.js."""

import html.parser
import json
import pathlib

SKIPPED = {"script", "style", "svg", "math", "nav"}
APART = {"p", "li", "td", "th", "dt", "dd", "h1", "h2", "h3", "h4", "pre", "div", "tr"}


class Article(html.parser.HTMLParser):
    """The text of the main part of a page."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.parts: list[str] = []
        self.inside, self.skipped = False, 0
        self.feed(page)

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        values = dict(attributes)
        if tag == "article" and values.get("role") == "main":
            self.inside = True
        self.skipped += tag in SKIPPED
        if tag in APART:
            self.parts.append(" ")

    def handle_endtag(self, tag: str) -> None:
        self.skipped -= tag in SKIPPED
        if tag == "article":
            self.inside = False

    def handle_data(self, data: str) -> None:
        if self.inside and not self.skipped and data != "¶":
            self.parts.append(data)

    def text(self) -> str:
        return " ".join("".join(self.parts).split())


def write(folder: pathlib.Path) -> None:
    texts = {
        path.relative_to(folder).with_suffix("").as_posix(): Article(path.read_text(encoding="utf-8")).text()
        for path in sorted(folder.rglob("*.html"))
        if path.name not in ("search.html", "genindex.html")
    }
    script = f"window.abbeSearchTexts = {json.dumps(texts, ensure_ascii=False)};\n"
    (folder / "_static/search_texts.js").write_text(script, encoding="utf-8")
