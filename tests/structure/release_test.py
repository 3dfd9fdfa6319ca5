"""The release is the same wherever it is written down, and the changelog has its form: releases, groups, one line per change."""
import datetime
import json
import os
import re
import unittest

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
GROUPS = ["Added", "Changed", "Deprecated", "Removed", "Fixed", "Security"]


def text_of(name):
    with open(os.path.join(ROOT, name), encoding="utf-8") as stream:
        return stream.read()


def found(pattern, name):
    match = re.search(pattern, text_of(name), re.M)
    assert match, f"{name} has no {pattern}"
    return match.group(1)


class Release(unittest.TestCase):
    def setUp(self):
        self.version = found(r"^project\(abbe VERSION ([0-9.]+) ", "CMakeLists.txt")
        self.date = found(r"^set\(ABBE_RELEASE_DATE ([0-9-]+)\)", "CMakeLists.txt")

    def test_version_and_date_are_the_same_everywhere(self):
        datetime.date.fromisoformat(self.date)
        self.assertEqual(found(r"^version: (.+)$", "CITATION.cff"), self.version)
        self.assertEqual(found(r"^date-released: (.+)$", "CITATION.cff"), self.date)
        self.assertEqual(json.loads(text_of("web/package.json"))["version"], self.version)
        lock = json.loads(text_of("web/package-lock.json"))
        self.assertEqual((lock["version"], lock["packages"][""]["version"]), (self.version, self.version))
        self.assertEqual(found(r'`"abbe ([0-9.]+)"`', "docs/report-data.md"), self.version)
        for name in re.findall(r"abbe(?:-linuxcnc|-dev)?[_-]([0-9.]+[0-9])[-_]", text_of("docs/installing.md")):
            self.assertEqual(name, self.version)
        self.assertIn(f"\n## {self.version} - {self.date}\n", text_of("CHANGELOG.md"))


class Changelog(unittest.TestCase):
    def test_it_is_read_in_a_minute(self):
        lines = text_of("CHANGELOG.md").split("\n## ", 1)[1].splitlines()
        self.assertEqual(lines[0], "Unreleased")
        for number, line in enumerate(lines[1:], 2):
            if line.startswith("## "):
                self.assertRegex(line, r"^## [0-9]+\.[0-9]+\.[0-9]+ - \d{4}-\d\d-\d\d$")
            elif line.startswith("### "):
                self.assertIn(line[4:], GROUPS)
            elif line:
                self.assertTrue(line.startswith("- ") and line.endswith("."), f"one line per change, a sentence: {line}")
                self.assertLessEqual(len(line), 120, line)


if __name__ == "__main__":
    unittest.main()
