"""The check of the documents finds every kind of violation, and nothing in a tree that is in order."""
import os
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from check_documents import violations  # noqa: E402
from check_structure import ORDER  # noqa: E402


def table(**changed):
    rows = {library: f"`{library}.h`" for library in ORDER} | changed
    return "".join(f"| `{library}` | what it holds | {cell} |\n" for library, cell in rows.items())


class CheckDocuments(unittest.TestCase):
    def found(self, files):
        headers = "\n  ".join(f"{library}/{library}.h" for library in ORDER)
        with tempfile.TemporaryDirectory() as root:
            for path, text in {**{f"include/abbe/{library}/{library}.h": "" for library in ORDER}, "include/abbe/machine/axis.h": "", "src/abbe/machine/axis_test.cpp": "", "fuzz/fuzz_nc.cpp": "",
                               "tests/header_examples/CMakeLists.txt": headers, **files}.items():
                os.makedirs(os.path.dirname(os.path.join(root, path)) or root, exist_ok=True)
                with open(os.path.join(root, path), "w", encoding="utf-8") as stream:
                    stream.write(text)
            return [f"{path}:{line}: {message}" for path, line, message in violations(root)]

    def test_what_exists_is_in_order(self):
        self.assertEqual(self.found({
            "README.md": "`include/abbe/machine`, `abbe/machine/axis.h`, `axis.h`, `NAME_test.cpp`, `axis_*`, src/gone, `a.hpp`\n"
                         "```sh\nfuzz/fuzz_NAME.cpp   include/abbe/*/axis.h\nabbe run x.study.toml\n```\n",
            "CHANGELOG.md": "`src/abbe/gone.h`\n", "docs/architecture.md": table()}), [])

    def test_what_does_not_exist_is_found(self):
        for code in ("`src/abbe/machine/gone.h`", "`abbe/machine/gone.h`", "`apps/`x, `apps/gone.cpp`", "`abbe --x tests/gone`",
                     "`gone.h`", "```\nsrc/abbe/gone   a folder\n```", "```cpp\n#include <abbe/machine/gone.h>\n```"):
            found = self.found({"docs/page.md": f"text\n{code}\n"})
            self.assertEqual(len(found), 1, (code, found))
            self.assertIn("gone", found[0])
            self.assertTrue(found[0].startswith("docs/page.md:"), found)

    def test_headers_that_a_header_with_an_example_names_exist(self):
        comment = "#pragma once\n\n// machine:\n//   machine.h, axis.h, room/far.h, abbe/plan/plan.h  <stdio.h>\n"
        far = {"include/abbe/machine/room/far.h": ""}
        self.assertEqual(self.found({**far, "include/abbe/machine/machine.h": comment}), [])
        for old, new in (("axis.h", "gone.h"), ("room/far.h", "axis/far.h"), ("plan/plan.h", "plan/gone.h")):
            found = self.found({**far, "include/abbe/machine/machine.h": comment.replace(old, new)})
            self.assertEqual(len(found), 1, found)
            self.assertTrue(found[0].startswith("include/abbe/machine/machine.h:4: no header is called"), found)

    def test_prose_ends_in_column_120(self):
        words, wide = "µ " * 59 + "µµ", "µ " * 60 + "µ"
        self.assertEqual(len(words), 120)
        self.assertEqual(self.found({"docs/page.md": f"{words}\n| {wide} |\n```\n{wide}\n```\n    {wide}\n{'x' * 130}\n{' ' * 130}\n",
                                     "tests/golden/README.md": f"{wide}\n"}), [])
        self.assertEqual(self.found({"docs/page.md": f"text\n{wide}\n"}),
                         ["docs/page.md:2: 121 columns, expected at most 120"])

    def test_every_library_has_one_header_that_is_run(self):
        for cell, words in (("`machine.h`, `axis.h`", "found 2"), ("see there", "found 0"), ("`axis.h`", "not among the examples")):
            found = self.found({"docs/architecture.md": table(machine=cell)})
            self.assertEqual(len(found), 1, found)
            self.assertIn(words, found[0])
        self.assertIn("expected a table", self.found({"docs/architecture.md": table().replace("`plan`", "`plans`")})[0])


if __name__ == "__main__":
    unittest.main()
