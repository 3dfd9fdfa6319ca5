"""The script .ci/build: when it configures, what it says at the start and in a log, and its exit code."""
import json
import os
import shutil
import subprocess
import tempfile
import unittest

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
PROJECT = """cmake_minimum_required(VERSION 3.25)
project(small LANGUAGES NONE)
set(FAILING OFF CACHE BOOL "")
file(APPEND ${CMAKE_BINARY_DIR}/configured "once\\n")
foreach(i RANGE 1 40)
  add_custom_command(OUTPUT made${i} COMMAND ${CMAKE_COMMAND} -E touch made${i} DEPENDS ${CMAKE_SOURCE_DIR}/source)
  list(APPEND made made${i})
endforeach()
if(FAILING)
  add_custom_command(OUTPUT broken COMMAND ${CMAKE_COMMAND} -E echo this is broken COMMAND ${CMAKE_COMMAND} -E false)
  list(APPEND made broken)
endif()
add_custom_target(all_of_it ALL DEPENDS ${made})
"""


class BuildScript(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.tree = folder.name
        os.mkdir(os.path.join(self.tree, ".ci"))
        shutil.copy(os.path.join(ROOT, ".ci/build"), os.path.join(self.tree, ".ci/build"))
        self.write("CMakeLists.txt", PROJECT)
        self.write("source", "")
        self.presets()

    def write(self, name, text):
        with open(os.path.join(self.tree, name), "w", encoding="utf-8") as out:
            out.write(text)

    def presets(self, **variables):
        self.write("CMakePresets.json", json.dumps({"version": 6, "configurePresets": [
            {"name": "small", "generator": "Ninja", "binaryDir": "${sourceDir}/build/small", "cacheVariables": variables}]}))

    def build(self, *arguments):
        environment = {name: value for name, value in os.environ.items() if not name.startswith(("CMAKE_", "NINJA_", "MAKE", "CCACHE_"))}
        done = subprocess.run([".ci/build", *arguments], cwd=self.tree, env=environment, stdin=subprocess.DEVNULL, capture_output=True,
                              text=True, timeout=60)
        return done.returncode, done.stdout

    def configured(self):
        with open(os.path.join(self.tree, "build/small/configured"), encoding="utf-8") as stream:
            return len(stream.readlines())

    def test_it_configures_only_when_something_has_changed(self):
        self.assertEqual(self.build("--configure", "small"), (0, ""))
        self.assertEqual(self.build("small")[0], 0)
        self.assertEqual(self.build("small")[0], 0)
        self.assertEqual(self.configured(), 1)
        for _ in range(2):
            self.assertEqual(self.build("small", "-DOTHER=1")[0], 0)
        self.assertEqual(self.configured(), 2)
        self.presets(MORE="1")
        for _ in range(2):
            self.assertEqual(self.build("small", "-DOTHER=1")[0], 0)
        self.assertEqual(self.configured(), 3)
        # Somebody else's change of the cache does not last.
        subprocess.run(["cmake", "-DOTHER=2", "build/small"], cwd=self.tree, check=True, capture_output=True)
        self.assertEqual(self.build("small", "-DOTHER=1")[0], 0)
        self.assertEqual(self.configured(), 5)
        # A changed list is ninja's affair, also when nothing is built.
        os.utime(os.path.join(self.tree, "CMakeLists.txt"))
        self.assertEqual(self.build("--configure", "small", "-DOTHER=1"), (0, ""))
        self.assertEqual(self.configured(), 6)

    def test_ccache_is_used_from_the_moment_it_is_there(self):
        commands = os.path.join(self.tree, "commands")
        os.mkdir(commands)
        for name in ("bash", "cat", "cksum", "cmake", "dirname", "grep", "ninja", "nproc"):
            os.symlink(shutil.which(name), os.path.join(commands, name))
        for launcher in ("", "ccache", "ccache"):
            if launcher and not os.path.lexists(os.path.join(commands, launcher)):
                os.symlink(shutil.which("cat"), os.path.join(commands, launcher))
            subprocess.run([shutil.which("bash"), ".ci/build", "small"], cwd=self.tree, env={"PATH": commands}, check=True,
                           stdin=subprocess.DEVNULL, capture_output=True, timeout=60)
            with open(os.path.join(self.tree, "build/small/CMakeCache.txt"), encoding="utf-8") as cache:
                self.assertRegex(cache.read(), f"(?m)^CMAKE_CXX_COMPILER_LAUNCHER:[A-Z]+={launcher}$")
        self.assertEqual(self.configured(), 2)

    def test_the_time_is_said_only_when_there_is_something_to_build(self):
        code, out = self.build("--expect", "6", "It is built", "small")
        self.assertEqual(code, 0)
        self.assertRegex(out.splitlines()[0], "^It is built: 4[0-9] steps .* 6 minutes")
        code, out = self.build("--expect", "6", "It is built", "small")
        self.assertEqual(code, 0)
        self.assertNotIn("minutes", out)
        os.utime(os.path.join(self.tree, "source"), (2e9, 2e9))
        self.assertIn("minutes", self.build("--expect", "6", "It is built", "small")[1])

    def test_a_log_has_a_line_for_every_tenth(self):
        code, out = self.build("small")
        self.assertEqual(code, 0)
        status = [line for line in out.splitlines() if line.startswith("[")]
        self.assertGreaterEqual(len(status), 10)
        self.assertLessEqual(len(status), 11)
        self.assertIn("100%", status[-1])

    def test_a_failing_build_fails_and_says_why(self):
        code, out = self.build("small", "-DFAILING=ON")
        self.assertNotEqual(code, 0)
        self.assertIn("this is broken", out)
        self.assertNotEqual(self.build("--configure", "no_such_preset")[0], 0)

    def test_wrong_use_is_exit_code_2(self):
        for arguments in ([], ["--expect", "6"], ["--bogus", "small"]):
            self.assertEqual(self.build(*arguments)[0], 2)


if __name__ == "__main__":
    unittest.main()
