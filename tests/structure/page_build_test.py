"""The page of the report is made once for all build folders, and its packages are installed once: web/page.cmake."""
import os
import shutil
import stat
import subprocess
import sys
import tempfile
import unittest

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
NPM = """
import os, sys, time
assert sys.argv[1] == "ci"
open(os.environ["ABBE_TEST_LOG"], "a").write("npm\\n")
time.sleep(0.2)
os.makedirs("node_modules", exist_ok=True)
open("node_modules/.package-lock.json", "w").write("{}")
"""
NODE = """
import os, sys, time
here = os.path.dirname(sys.argv[1])
assert os.path.exists(os.path.join(here, "node_modules/.package-lock.json"))
open(os.environ["ABBE_TEST_LOG"], "a").write("node\\n")
time.sleep(0.2)
text = open(os.path.join(here, "src/main.ts")).read()
for name in (sys.argv[sys.argv.index("--html") + 1], sys.argv[sys.argv.index("--cpp") + 1]):
    os.makedirs(os.path.dirname(name), exist_ok=True)
    open(name, "w").write(text)
"""


class PageBuild(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="abbe page ")
        self.addCleanup(folder.cleanup)
        self.root = folder.name
        self.web = os.path.join(self.root, "web")
        self.log = os.path.join(self.root, "log")
        os.makedirs(os.path.join(self.web, "src"))
        for name in ("page.cmake", "install.cmake"):
            shutil.copy(os.path.join(ROOT, "web", name), self.web)
        for name in ("build.mjs", "tsconfig.json", "package.json", "package-lock.json"):
            self.write("web/" + name, "{}")
        self.write("web/src/main.ts", "first")
        for name, body in (("npm", NPM), ("node", NODE)):
            self.write(name, f"#!{sys.executable}{body}")
            path = os.path.join(self.root, name)
            os.chmod(path, os.stat(path).st_mode | stat.S_IXUSR)

    def write(self, name, text):
        with open(os.path.join(self.root, name), "w", encoding="utf-8") as out:
            out.write(text)

    def read(self, name):
        with open(os.path.join(self.root, name), encoding="utf-8") as stream:
            return stream.read()

    def start(self, folder):
        os.makedirs(os.path.join(self.root, folder), exist_ok=True)
        at = {"WEB": self.web, "NODE": os.path.join(self.root, "node"), "NPM": os.path.join(self.root, "npm"),
              "SHARED": os.path.join(self.root, "build/web"), "OUT": os.path.join(self.root, folder)}
        return subprocess.Popen(["cmake", *(f"-D{name}={value}" for name, value in at.items()), "-P", os.path.join(self.web, "page.cmake")],
                                env={**os.environ, "ABBE_TEST_LOG": self.log}, stderr=subprocess.PIPE, text=True)

    def make(self, *folders):
        """Makes the page in these build folders at the same time; says how often npm and node ran."""
        open(self.log, "w", encoding="utf-8").close()
        for program in [self.start(folder) for folder in folders]:
            error = program.communicate(timeout=60)[1]
            self.assertEqual(program.returncode, 0, error)
        calls = self.read("log").split()
        return calls.count("npm"), calls.count("node")

    def assert_page(self, folder, text):
        for name in ("report.html", "page_template.cpp"):
            self.assertEqual(self.read(f"{folder}/{name}"), text)

    def test_build_folders_at_the_same_time_share_one_page(self):
        self.assertEqual(self.make("a", "b", "c"), (1, 1))
        for folder in ("a", "b", "c"):
            self.assert_page(folder, "first")
        self.assertEqual(self.make("d"), (0, 0))
        self.assert_page("d", "first")

    def test_a_changed_source_makes_a_new_page_with_the_packages_that_are_there(self):
        self.make("a")
        self.write("web/src/main.ts", "second")
        self.assertEqual(self.make("a", "b"), (0, 1))
        self.assert_page("a", "second")
        self.assert_page("b", "second")
        # A younger file of the same contents changes nothing that is compiled.
        before = os.stat(os.path.join(self.root, "a/page_template.cpp")).st_mtime_ns
        os.utime(os.path.join(self.web, "src/main.ts"))
        self.assertEqual(self.make("a"), (0, 0))
        self.assertEqual(os.stat(os.path.join(self.root, "a/page_template.cpp")).st_mtime_ns, before)

    def test_packages_follow_the_contents_of_the_lock_file(self):
        self.make("a")
        os.utime(os.path.join(self.web, "package-lock.json"))
        self.assertEqual(self.make("a"), (0, 0))
        self.write("web/package-lock.json", "{ }")
        self.assertEqual(self.make("a"), (1, 1))
        shutil.rmtree(os.path.join(self.web, "node_modules"))
        self.assertEqual(self.make("a"), (1, 0))

    def test_packages_that_somebody_installed_by_hand_are_used(self):
        os.mkdir(os.path.join(self.web, "node_modules"))
        self.write("web/node_modules/.package-lock.json", "{}")
        self.assertEqual(self.make("a"), (0, 1))

    def test_where_nothing_can_be_shared_the_build_folder_has_it_all(self):
        self.write("build", "a file where the folder would be")
        self.assertEqual(self.make("a", "b"), (2, 2))
        self.assert_page("a", "first")
        self.assert_page("b", "first")
        self.assertFalse(os.path.exists(os.path.join(self.web, "node_modules")))
        self.assertEqual(self.make("a"), (0, 0))

    def test_what_the_page_depends_on_is_told_with_the_folder(self):
        self.make("a")
        told = self.read("a/page.d").replace("\\ ", " ")
        self.assertIn("src/main.ts", told)
        self.assertTrue(told.rstrip().endswith("web/src"), told)

    def test_packages_that_cannot_be_fetched_are_an_error_with_npms_words(self):
        self.write("npm", f"#!{sys.executable}\nimport sys\nsys.exit('no network today')\n")
        program = self.start("a")
        error = program.communicate(timeout=60)[1]
        self.assertNotEqual(program.returncode, 0)
        self.assertIn("no network today", error)
        self.assertFalse(os.path.exists(os.path.join(self.root, "a/report.html")))


if __name__ == "__main__":
    unittest.main()
