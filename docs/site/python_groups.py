"""Which public names belong together: by the table "What there is" of docs/python.md, and by what they give and take.

A name that the table does not list goes to the first row with a function that gives it, else with another name that
gives it, else with a function that takes it; a function to the row of what it gives, a constant to the row that speaks
of it. What is left goes to the last group, "Other names"."""

import pathlib
import re
from collections.abc import Callable
from dataclasses import dataclass, field

from python_source import Name

HEADING = "## What there is"
ROW = re.compile(r"^\| (`[^|]*`) \| ([^|]*) \| ([^|]*)\|$")
CODE = re.compile(r"`([^`]+)`")


@dataclass
class Group:
    """A row of the table: what it is about, the headers of C++ it names, and its names of the package."""

    listed: list[str]
    about: str
    headers: list[str] = field(default_factory=list)
    names: list[str] = field(default_factory=list)


def rows(document: pathlib.Path) -> list[Group]:
    text = document.read_text(encoding="utf-8")
    _, heading, rest = text.partition(HEADING)
    lines = rest.partition("\n## ")[0].splitlines()
    found = [
        Group(CODE.findall(match[1]), match[2].strip(), CODE.findall(match[3]))
        for match in map(ROW.match, lines)
        if match
    ]
    if not heading or not found:
        raise ValueError(f"{document}: expected a table of names below '{HEADING}'")
    return found


def groups(document: pathlib.Path, names: dict[str, Name]) -> list[Group]:
    """All groups that have names of the package; a row of a module (`abbe.plot`) has its name alone."""
    table = rows(document)
    unknown = [name for group in table for name in group.listed if "." not in name and name not in names]
    if unknown:
        raise ValueError(f"{document}: the table names what abbe.__all__ does not have: {', '.join(unknown)}")
    place: dict[str, int] = {}
    for number, group in enumerate(table):
        place.update({name: number for name in group.listed if name in names})

    def settle(candidates: Callable[[str], list[int]]) -> bool:
        """One round; what it places counts from the next round on."""
        found = {}
        for name in names:
            if name not in place:
                numbers = candidates(name)
                if numbers:
                    found[name] = numbers[0]
        place.update(found)
        return bool(found)

    def placed(test: Callable[[Name], bool]) -> list[int]:
        return sorted(number for other, number in place.items() if test(names[other]))

    def given_by_function(name: str) -> list[int]:
        return placed(lambda one: one.kind == "function" and name in one.gives)

    def given_by(name: str) -> list[int]:
        return placed(lambda one: name in one.gives)

    def taken_by(name: str) -> list[int]:
        return placed(lambda one: one.kind == "function" and name in one.takes) if names[name].kind == "class" else []

    def by_result(name: str) -> list[int]:
        one = names[name]
        return sorted(place[word] for word in one.gives if word in place) if one.kind == "function" else []

    def by_words(name: str) -> list[int]:
        def says(one: Name) -> bool:
            return any(re.search(rf"\b{name}\b", text) for text in [one.doc, *(member.doc for member in one.members)])

        return placed(says) if names[name].kind == "data" else []

    while any(map(settle, (given_by_function, given_by, taken_by, by_result, by_words))):
        pass
    table.append(Group([], "names that belong to no task"))
    for name in names:
        table[place.get(name, len(table) - 1)].names.append(name)
    for group in table:
        # Those of the table first, in its order; parts of results last.
        group.names.sort(
            key=lambda name, group=group: (
                not names[name].exported,
                group.listed.index(name) if name in group.listed else len(group.listed),
            )
        )
    return [group for group in table if group.names or any("." in name for name in group.listed)]
