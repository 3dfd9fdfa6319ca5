"""Examples are taken from the first comment of a header, and what is wrong with one is said with its line."""
import os
import sys
import unittest

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from write_examples import MOST_LINES, NoExample, example_of, name_of, source_of  # noqa: E402

HEADER = "machine/machine.h"
TEXT = """#pragma once

// A machine:
//
//   #include <abbe/machine/machine.h>
//
//   #include <cstdio>
//
//   int main() {
//     std::puts("one\\n");
//     return 0;
//   }
//
// It prints:
//
//   one
//
//     two
//
// machine holds machines:
//   machine.h  them

#include <vector>
"""


class WriteExamples(unittest.TestCase):
    def wrong(self, text):
        with self.assertRaises(NoExample) as caught:
            example_of(text, HEADER, ["geometry", "machine"])
        return caught.exception.args

    def test_program_and_output_are_taken_without_their_indentation(self):
        program, printed = example_of(TEXT, HEADER, ["geometry", "machine"])
        self.assertEqual(printed, "one\n\n  two\n")
        self.assertEqual(program[0], (5, "#include <abbe/machine/machine.h>"))
        self.assertEqual(source_of(program, HEADER, name_of(HEADER)),
                         '#line 5 "include/abbe/machine/machine.h"\n#include <abbe/machine/machine.h>\n\n#include <cstdio>\n\n'
                         'extern "C" int example_machine_machine() {\n  std::puts("one\\n");\n  return 0;\n}\n')

    def test_a_program_with_void_is_c(self):
        program, _ = example_of(TEXT.replace("main()", "main(void)"), HEADER, ["machine"])
        self.assertIn("\nint example_machine_machine(void) {\n", source_of(program, HEADER, name_of(HEADER)))

    def test_what_is_wrong_is_said_with_its_line(self):
        body = '//     std::puts("one\\n");\n'
        for old, new, line, words in (
                ("// A machine:\n", "#include <map>\n\n// A machine:\n", 1, "in the first comment"),
                ("int main() {", "int main(int, char**) {", 1, "int main() {"),
                ("<abbe/machine/machine.h>", "<abbe/machine/axis.h>", 5, "does not include <abbe/machine/machine.h>"),
                ("<cstdio>", "<abbe/errors/basis.h>", 7, "'errors' is none of geometry machine"),
                ("<cstdio>", '"abbe/machine/axis.h"', 7, "expected '#include <...>'"),
                ("// It prints:", "// And so on:", 12, "expected '// It prints:'"),
                (body, body * MOST_LINES, 36, f"{MOST_LINES + 5} lines of example; at most {MOST_LINES}")):
            with self.subTest(new):
                at, message = self.wrong(TEXT.replace(old, new))
                self.assertEqual(at, line)
                self.assertIn(words, message)


if __name__ == "__main__":
    unittest.main()
