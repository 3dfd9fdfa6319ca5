"""The check of the sources finds names that two sources of one library share, and nothing where names may be the same."""
import os
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from check_sources import violations  # noqa: E402

A, B = "src/abbe/machine/a.cpp", "src/abbe/machine/rooms/b.cpp"


class CheckSources(unittest.TestCase):
    def found(self, files):
        with tempfile.TemporaryDirectory() as root:
            for path, text in files.items():
                os.makedirs(os.path.dirname(os.path.join(root, path)), exist_ok=True)
                with open(os.path.join(root, path), "w", encoding="utf-8") as stream:
                    stream.write(text)
            return [f"{path}:{line}: {message}" for path, line, message in violations(root)]

    def test_a_name_in_two_sources_of_a_library_is_found(self):
        for first, second, name in (
                ("constexpr double kTurn = 6;\n", "const std::array<double, 2> kTurn{1, 2};\n", "kTurn"),
                ("struct Row {\n", "class Row : public Line {\n", "Row"),
                ("void show(int rows, const Row& row) {\n", "void show(int n,\n          const Row& of) {\n", "show(int, const Row&)")):
            found = self.found({A: first, B: "\n" + second})
            self.assertEqual(found, [f"{B}:2: '{name}' is also in {A}, and both may be compiled in one unit"])

    def test_a_name_of_a_public_header_is_found(self):
        header = {"include/abbe/geometry/turn.h": "inline constexpr double kTurn = 6;\n"}
        self.assertEqual(self.found({**header, A: "constexpr double kTurn = 6;\n"}),
                         [f"{A}:1: 'kTurn' is also in include/abbe/geometry/turn.h, which a source of the same unit may include"])

    def test_overloads_of_which_the_address_is_taken_are_found(self):
        files = {"python/bindings/a.cpp": "void f(int a) {\n}\n", "python/bindings/b.cpp": "void f(double a) {\n  def(\"f\", &f);\n"}
        self.assertEqual(self.found(files),
                         ["python/bindings/b.cpp:1: 'f(double)' is also in python/bindings/a.cpp, and both may be compiled in one unit"])

    def test_names_that_never_meet_are_in_order(self):
        constant = "constexpr double kTurn = 6;\n"
        for files in ({A: constant, "src/abbe/errors/b.cpp": constant, "apps/c.cpp": constant, "src/abbe/machine/d_test.cpp": constant},
                      {A: constant, "include/abbe/errors/turn.h": constant},  # below: a source of `machine` cannot include it
                      {A: "void f(int a) {\n}\nvoid f(double a) {\n", B: "void f(const std::pair<int, int>& a) {\n"},
                      {A: "struct Row;\n  constexpr int kOne = 1;\n", B: "struct Row {\n  int kOne = 1;\n"}):
            self.assertEqual(self.found(files), [])


if __name__ == "__main__":
    unittest.main()
