"""Content-Security-Policy of the pages: own files only, and of scripts in a page only those that it has now."""

import base64
import hashlib
import pathlib
import re

INLINE = re.compile(r"<(script|style)(?: [^>]*)?>(.+?)</\1>", re.DOTALL)
SOURCE = re.compile(r"^<script[^>]* src=")
PLACE = '<meta charset="utf-8">'


def policy_of(page: str) -> str:
    """The policy as the content of a `meta` element."""
    hashes: dict[str, list[str]] = {"script": [], "style": []}
    for match in INLINE.finditer(page):
        if SOURCE.match(match.group()):
            continue
        digest = base64.b64encode(hashlib.sha256(match.group(2).encode()).digest()).decode()
        if f"'sha256-{digest}'" not in hashes[match.group(1)]:
            hashes[match.group(1)].append(f"'sha256-{digest}'")
    rules = {
        "default-src": ["'none'"],
        "script-src": ["'self'", *hashes["script"]],
        "style-src-elem": ["'self'", *hashes["style"]],
        "style-src-attr": ["'unsafe-inline'"],  # widths of columns
        "img-src": ["'self'", "data:"],
        "form-action": ["'self'"],
        "base-uri": ["'none'"],
    }
    return "; ".join(" ".join([name, *values]) for name, values in rules.items())


def add_policies(folder: pathlib.Path) -> None:
    for path in sorted(folder.rglob("*.html")):
        page = path.read_text(encoding="utf-8")
        if "Content-Security-Policy" in page:
            continue
        if PLACE not in page:
            raise ValueError(f"{path}: no place for the content security policy; expected {PLACE}")
        policy = f'<meta http-equiv="Content-Security-Policy" content="{policy_of(page)}">'
        path.write_text(page.replace(PLACE, PLACE + policy, 1), encoding="utf-8")
