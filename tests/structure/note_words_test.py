"""The English formats of notes in customer reports are what the library says, letter for letter.

src/abbe/report/customer/*_note_words.cpp translate sentences that are made elsewhere. If a sentence changes there, its
translation is no longer found, so the parts of every format between its places must stand in some other source.
"""

import pathlib
import re
import sys
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
TABLES = sorted((ROOT / "src/abbe/report/customer").glob("*_note_words.cpp"))
LITERALS = re.compile(r'"(?:[^"\\\n]|\\.)*"(?:\s*"(?:[^"\\\n]|\\.)*")*')
ONE = re.compile(r'"((?:[^"\\\n]|\\.)*)"')


def text_of(literals):
    """Adjacent literals as one text."""
    joined = "".join(ONE.findall(literals))
    # Bytes of UTF-8 and letters are the same text.
    as_bytes = re.sub(rb"\\x([0-9A-Fa-f]{2})", lambda m: bytes([int(m[1], 16)]), joined.encode())
    return as_bytes.decode("utf-8", "replace").replace('\\"', '"')


def literals_of(path):
    code = re.sub(r"^\s*//.*$", "", path.read_text(encoding="utf-8"), flags=re.M)
    return [text_of(found) for found in LITERALS.findall(code)]


def formats_of(path):
    """The English format of each word, which begins an entry."""
    code = path.read_text(encoding="utf-8")
    return [text_of(found) for found in re.findall(r"^    \{(" + LITERALS.pattern + r"),\s*\{\"", code, re.M)]


def parts_of(text):
    return [part.strip() for part in re.split(r"\{[^}]*\}", text) if len(part.strip()) > 2]


#: Sentences that are put together from several texts; customer_notes_test.cpp and customer_study_test.cpp make them.
PUT_TOGETHER = re.compile(
    r"^\{\} of \{\} poses |^\{\} (lies?|needs?|cannot) |^\{\} points? lies? |^(Predicted|True) volumetric error|^Residual of the readings|usual size|"
    r"^(Accepted despite doubts|Not to be trusted) \(|of the volumetric error lie there|beyond the choice of the workpiece datum|others: the robust loss|um before, ")


class NoteWords(unittest.TestCase):
    def test_every_part_of_a_format_stands_in_a_source(self):
        sources = [path for suffix in ("*.cpp", "*.h") for folder in ("src", "include")
                   for path in sorted((ROOT / folder).rglob(suffix))]
        made = "\0".join(text for path in sources if path not in TABLES and not path.name.endswith("_test.cpp")
                         for text in literals_of(path))
        formats = [text for path in TABLES for text in formats_of(path)]
        self.assertGreater(len(formats), 100)
        self.assertEqual(len(formats), len(set(formats)), "a format stands twice")
        for text in formats:
            for part in [] if PUT_TOGETHER.search(text) else parts_of(text):
                with self.subTest(format=text):
                    self.assertTrue(part in made, f"nothing says '{part}'")


if __name__ == "__main__":
    sys.exit(unittest.main())
