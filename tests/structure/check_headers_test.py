"""The check of the headers finds what a header uses and does not include, and nothing in headers that stand alone."""
import os
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from check_headers import violations  # noqa: E402


class CheckHeaders(unittest.TestCase):
    def found(self, text):
        with tempfile.TemporaryDirectory() as root:
            folder = os.path.join(root, "include/abbe/machine")
            os.makedirs(folder)
            for name, contents in {"axis.h": "#include <vector>\nstruct Axis {\n};\nusing Axes = std::vector<Axis>;\n",
                                   "chain.h": '#include "abbe/machine/axis.h"\n', "used.h": text}.items():
                with open(os.path.join(folder, name), "w", encoding="utf-8") as stream:
                    stream.write(contents)
            return [f"{path}:{line}: {message}" for path, line, message in violations(root)]

    def test_headers_that_stand_alone_are_in_order(self):
        for text in ('#include "abbe/machine/chain.h"\nAxes f(const Axis& axis, std::size_t n);\n',
                     "struct Axis;\nvoid f(const Axis& axis);\n", "// std::map of Axes\nint f();  /* std::set\n Axis */\n",
                     '#include <string>\nstd::string f(const char* text = "std::map Axis");\n',
                     "#include <Eigen/Core>\nstd::function<void(std::size_t)> f();\n"):
            self.assertEqual(self.found(text), [])

    def test_what_is_not_included_is_found_with_its_line(self):
        for text, words in (("int g();\nAxes f();\n", "2: Axes: include \"abbe/machine/axis.h\""),
                            ("\n\nstd::map<int, int> f();\n", "3: std::map: include <map>"),
                            ('#include "abbe/machine/chain.h"\nstd::optional<Axis> f();\n', "2: std::optional: include <optional>"),
                            ("/* one\n two */ std::size_t f();\n", "2: std::size_t: include <cstddef>")):
            self.assertEqual(self.found(text), [f"include/abbe/machine/used.h:{words}"])


if __name__ == "__main__":
    unittest.main()
