"""The structure check finds every kind of violation, and nothing in a tree that is in order."""
import os
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from check_structure import violations  # noqa: E402


class CheckStructure(unittest.TestCase):
    def found(self, files):
        with tempfile.TemporaryDirectory() as root:
            for path, text in {"include/abbe/geometry/line.h": "#pragma once\n", **files}.items():
                os.makedirs(os.path.dirname(os.path.join(root, path)), exist_ok=True)
                with open(os.path.join(root, path), "w", encoding="utf-8") as stream:
                    stream.write(text)
            return [f"{path}:{line}: {message}" for path, line, message in violations(root)]

    def assert_one(self, files, start, words):
        found = self.found(files)
        self.assertEqual(len(found), 1, found)
        self.assertTrue(found[0].startswith(start), found)
        self.assertIn(words, found[0])

    def test_a_tree_in_order_has_no_violations(self):
        self.assertEqual(self.found({
            "src/abbe/machine/axis.cpp": '#include <vector>\n\n#include "abbe/geometry/line.h"\n',
            "src/abbe/formats/file.cpp": '#include <fstream>\n#include "abbe/geometry/line.h"\n',
            "apps/main.cpp": '#include <cstdio>\n#include "abbe/geometry/line.h"\n'}), [])

    def test_including_a_folder_below_is_found(self):
        self.assert_one({"include/abbe/machine/axis.h": "#pragma once\n",
                         "src/abbe/geometry/a.cpp": '#include <cmath>\n#include "abbe/machine/axis.h"\n'},
                        "src/abbe/geometry/a.cpp:2:", "below it")

    def test_internal_headers_are_for_their_own_library(self):
        internal = {"src/abbe/geometry/tree.h": "#pragma once\n"}
        include = '#include "abbe/geometry/tree.h"\n'
        for insider in ("src/abbe/geometry/tree.cpp", "src/abbe/machine/axis_test.cpp", "tests/a.cpp", "benchmarks/a.cpp"):
            self.assertEqual(self.found({**internal, insider: include}), [])
        for outsider in ("src/abbe/machine/axis.cpp", "apps/main.cpp", "papers/main.cpp"):
            self.assert_one({**internal, outsider: include}, f"{outsider}:1:", "internal to 'geometry'")
        self.assert_one({**internal, "include/abbe/geometry/point.h": "#pragma once\n" + include},
                        "include/abbe/geometry/point.h:2:", "this header is public")

    def test_a_page_of_its_own_and_a_template_without_policy_are_found(self):
        self.assert_one({"apps/a.cpp": 'const char* text =\n    "<!doctype html>";\n'}, "apps/a.cpp:2:", "a page of its own")
        self.assertEqual(self.found({"apps/a_test.cpp": '"<!doctype html>"\n'}), [])
        self.assert_one({"web/src/template.html": "<html lang=en>\n"}, "web/src/template.html:1:", "no content security policy")

    def test_one_name_for_two_types_is_found(self):
        self.assert_one({"src/abbe/errors/a.h": "#pragma once\nstruct Motion {\n};\nstruct Other;\n",
                         "src/abbe/verify/b.h": "#pragma once\nstruct Other;\nclass Motion : public X {\n};\n"},
                        "src/abbe/verify/b.h:3:", "'Motion' is also in src/abbe/errors/a.h")

    def test_identify_and_compensate_do_not_see_each_other(self):
        headers = {"include/abbe/identify/a.h": "#pragma once\n", "include/abbe/compensate/b.h": "#pragma once\n"}
        for source, target in (("identify/x.cpp", "compensate/b.h"), ("compensate/x.cpp", "identify/a.h")):
            self.assert_one({**headers, f"src/abbe/{source}": f'#include "abbe/{target}"\n'},
                            f"src/abbe/{source}:1:", "do not see each other")

    def test_including_a_paper_is_found(self):
        paper = {"papers/wang/study.h": "#pragma once\n", "papers/main.cpp": '#include "wang/study.h"\n', "apps/main.h": "#pragma once\n"}
        self.assertEqual(self.found({**paper, "apps/a.cpp": '#include "main.h"\n'}), [])
        for target in ("wang/study.h", "papers/wang/study.h", "../papers/wang/study.h"):
            self.assert_one({**paper, "apps/a.cpp": f'#include "main.h"\n#include "{target}"\n'}, "apps/a.cpp:2:", "does without")

    def test_including_a_source_of_the_step_program_is_found(self):
        step = {"step/face_mesh.h": "#pragma once\n", "step/main.cpp": '#include "face_mesh.h"\n'}
        self.assertEqual(self.found({**step, "apps/step_reading.h": "#pragma once\n",
                                     "apps/a.cpp": '#include "step_reading.h"\n'}), [])
        for target in ("face_mesh.h", "step/face_mesh.h", "../step/face_mesh.h"):
            self.assert_one({**step, "apps/a.cpp": f'#include "{target}"\n'}, "apps/a.cpp:1:", "without 'step'")

    def test_touching_files_in_the_engine_is_found(self):
        for header in ("fstream", "cstdio", "filesystem"):
            self.assert_one({"src/abbe/verify/a.cpp": f"#include <{header}>\n"}, "src/abbe/verify/a.cpp:1:", "touch files")

    def test_an_include_that_does_not_exist_is_found(self):
        self.assert_one({"src/abbe/machine/a.cpp": '#include "abbe/geometry/gone.h"\n'},
                        "src/abbe/machine/a.cpp:1:", "does not exist")

    def test_a_relative_include_is_found(self):
        self.assert_one({"src/abbe/geometry/tree.h": "#pragma once\n", "src/abbe/geometry/a.cpp": '#include "tree.h"\n'}, "src/abbe/geometry/a.cpp:1:", "from abbe/")

    def test_an_include_written_twice_is_found(self):
        self.assert_one({"src/abbe/geometry/a.cpp": "#include <cmath>\n#include <vector>\n#include <cmath>\n"},
                        "src/abbe/geometry/a.cpp:3:", "twice")

    def test_a_header_without_pragma_once_is_found(self):
        self.assert_one({"src/abbe/geometry/a.h": "// nothing\n"}, "src/abbe/geometry/a.h:1:", "#pragma once")

    def test_a_long_file_is_found(self):
        self.assertEqual(self.found({"apps/a.cpp": "\n" * 500}), [])
        self.assert_one({"apps/a.cpp": "\n" * 501}, "apps/a.cpp:500:", "501 lines")
        self.assert_one({f"apps/a{k}.cpp": "\n" * 500 for k in range(14)} | {"apps/b.h": "#pragma once\n"}, "apps:1:",
                        "7001 lines")

    def test_a_folder_with_a_meaningless_name_is_found(self):
        self.assert_one({"apps/helpers/a.cpp": "\n"}, "apps/helpers:1:", "name")

    def test_a_folder_outside_the_order_is_found(self):
        self.assert_one({"src/abbe/extras/a.cpp": "\n"}, "src/abbe/extras:1:", "not in the order")


if __name__ == "__main__":
    unittest.main()
