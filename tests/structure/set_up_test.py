"""What .ci/set-up says and does on machines that lack packages: made of commands that only pretend, in a folder of their own."""
import os
import shutil
import stat
import subprocess
import tempfile
import unittest

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
REAL = ["bash", "cat", "dirname", "env", "find", "grep", "mkdir", "sort"]
BUILD_TOOLS = ["g++", "cmake", "ninja", "git", "python3", "npm", "ccache"]
BUILD_LIBRARIES = ["libeigen3-dev", "libfmt-dev", "libtomlplusplus-dev", "nlohmann-json3-dev", "libcli11-dev", "libhwy-dev",
                   "libboost-dev", "zlib1g-dev", "libexpat1-dev", "libsqlite3-dev", "libocct-data-exchange-dev"]
OPTIONAL = ["ccache", "libocct-data-exchange-dev"]


class Machine:
    """A folder with a copy of the script, and commands that write into a log how they were called."""

    def __init__(self, folder):
        self.folder = folder
        self.commands = os.path.join(folder, "commands")
        self.log = os.path.join(folder, "log")
        self.packages = os.path.join(folder, "packages")
        os.makedirs(os.path.join(folder, "tree/.ci"))
        os.makedirs(self.commands)
        shutil.copy(os.path.join(ROOT, ".ci/set-up"), os.path.join(folder, "tree/.ci/set-up"))
        for name in REAL:
            os.symlink(shutil.which(name), os.path.join(self.commands, name))
        self.user(1000)
        self.command("node", 'if [ "$1" = -p ]; then echo true; else echo v18.20.4; fi')
        for name in BUILD_TOOLS:
            self.command(name)
        self.debian()
        self.install(*BUILD_LIBRARIES)

    def command(self, name, body="exit 0"):
        path = os.path.join(self.commands, name)
        with open(path, "w", encoding="utf-8") as out:
            out.write(f'#!{shutil.which("bash")}\necho "{name} $*" >>"{self.log}"\n{body}\n')
        os.chmod(path, os.stat(path).st_mode | stat.S_IXUSR)

    def remove(self, *names):
        for name in names:
            os.remove(os.path.join(self.commands, name))

    def user(self, number):
        self.command("id", f"echo {number}")

    def install(self, *packages):
        with open(self.packages, "w", encoding="utf-8") as out:
            out.writelines(f"{package} installed\n" for package in packages)

    def debian(self, apt="exit 0"):
        self.command("apt-get", 'echo "apt-get says something"\n' + apt)
        self.command("dpkg-query", f'cat "{self.packages}"; exit 1')

    def set_up(self, *jobs):
        """Exit code, standard output, standard error, and what was called of apt-get and sudo."""
        if os.path.exists(self.log):
            os.remove(self.log)
        done = subprocess.run([shutil.which("bash"), os.path.join(self.folder, "tree/.ci/set-up"), *jobs], env={"PATH": self.commands},
                              stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=60)
        called = []
        if os.path.exists(self.log):
            with open(self.log, encoding="utf-8") as log:
                called = [line.strip() for line in log if line.startswith(("apt-get", "sudo"))]
        return done.returncode, done.stdout, done.stderr, called


class SetUp(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.machine = Machine(folder.name)

    def lines_with(self, text, words):
        return [line.strip() for line in text.splitlines() if words in line]

    def test_nothing_is_said_or_done_when_all_is_there(self):
        self.assertEqual(self.machine.set_up("build"), (0, "", "", []))

    def test_without_root_and_sudo_one_message_says_what_to_install(self):
        self.machine.remove("g++", "ninja", "ccache")
        self.machine.install("libeigen3-dev", "libfmt-dev", "libtomlplusplus-dev", "nlohmann-json3-dev", "libcli11-dev",
                             "libboost-dev", "zlib1g-dev", "libexpat1-dev", "libsqlite3-dev")
        code, out, err, called = self.machine.set_up("build")
        self.assertEqual((code, out, called), (1, "", []))
        self.assertEqual(self.lines_with(err, "apt-get install"), [
            "apt-get install --no-install-recommends g++ libhwy-dev ninja-build",
            "apt-get install --no-install-recommends ccache libocct-data-exchange-dev"])
        self.assertEqual(len(self.lines_with(err, "Optional")), 1, err)
        self.assertEqual(len(self.lines_with(err, "set-up:")), 1, err)
        self.assertIn("needs root or sudo", err)

    def test_sudo_that_needs_a_password_is_not_tried_without_a_terminal(self):
        self.machine.remove("g++")
        self.machine.command("sudo", 'echo "sudo: a password is required" >&2; exit 1')
        code, out, err, called = self.machine.set_up("build")
        self.assertEqual((code, out, called), (1, "", ["sudo -n true"]))
        self.assertEqual(self.lines_with(err, "apt-get install"), ["apt-get install --no-install-recommends g++"])
        self.assertNotIn("password is required", err)

    def test_it_goes_on_in_one_line_without_optional_packages(self):
        self.machine.remove("ccache")
        self.machine.install(*[name for name in BUILD_LIBRARIES if name not in OPTIONAL])
        code, out, err, called = self.machine.set_up("build")
        self.assertEqual((code, out, called), (0, "", []))
        self.assertEqual(err.count("\n"), 1, err)
        for name in OPTIONAL:
            self.assertIn(name, err)

    def test_another_system_is_told_the_names_once(self):
        self.machine.remove("apt-get", "dpkg-query", "cmake", "ccache")
        code, out, err, called = self.machine.set_up("build")
        self.assertEqual((code, out, called), (1, "", []))
        self.assertEqual(err.count("cmake"), 1, err)
        self.assertEqual(len(self.lines_with(err, "set-up:")), 1, err)
        self.assertNotIn("apt-get install", err)
        self.assertRegex(err, "Optional.*ccache")

    def test_another_system_is_not_told_of_commands_that_are_there(self):
        self.machine.remove("apt-get", "dpkg-query")
        _, _, err, called = self.machine.set_up("build")
        self.assertEqual(called, [])
        for name in ("g++", "cmake", "ninja-build", "nodejs"):
            self.assertNotIn(name, err)

    def test_root_and_usable_sudo_install_what_is_missing_in_one_go(self):
        self.machine.remove("g++")
        run = 'while [ "${1#-}" != "$1" ]; do shift; done; "$@"'
        for user, sudo in ((0, None), (1000, run)):
            self.machine.user(user)
            if sudo:
                self.machine.command("sudo", sudo)
            code, _, err, called = self.machine.set_up("build")
            self.assertEqual((code, err), (0, ""))
            installs = [call for call in called if call.startswith("apt-get install")]
            self.assertEqual(len(installs), 1, called)
            self.assertTrue(installs[0].endswith(" g++"), installs)
            self.assertEqual([call for call in called if call.startswith("sudo") and not call.startswith("sudo -n ")], [])

    def test_an_optional_package_that_cannot_be_had_takes_no_other_with_it(self):
        self.machine.user(0)
        self.machine.remove("g++", "ccache")
        self.machine.install(*[name for name in BUILD_LIBRARIES if name not in OPTIONAL])
        self.machine.debian(apt='case "$1 $*" in install*libocct*) exit 100;; esac')
        code, _, err, called = self.machine.set_up("build")
        self.assertEqual(code, 0, err)
        self.assertTrue(any(call.endswith("DPkg::Lock::Timeout=300 ccache") for call in called), called)
        self.assertTrue(any(call.endswith("DPkg::Lock::Timeout=300 g++") for call in called), called)
        self.assertRegex(err, "going on without libocct-data-exchange-dev")
        self.assertNotIn("ccache", err)
        # The next run does not try again what was refused.
        for name in ("g++", "ccache"):
            self.machine.command(name)
        code, out, err, called = self.machine.set_up("build")
        self.assertEqual((code, out, called), (0, "", []))
        self.assertEqual(err.count("\n"), 1, err)

    def test_apt_get_that_fails_ends_in_one_message(self):
        self.machine.user(0)
        self.machine.remove("g++")
        self.machine.debian(apt="exit 100")
        code, _, err, called = self.machine.set_up("build")
        self.assertEqual(code, 1)
        self.assertEqual(len([call for call in called if call.startswith("apt-get install")]), 1, called)
        self.assertEqual(self.lines_with(err, "apt-get install"), ["apt-get install --no-install-recommends g++"])

    def test_node_that_is_too_old_is_named_with_its_version(self):
        self.machine.command("node", 'if [ "$1" = -p ]; then echo false; else echo v12.22.9; fi')
        code, _, err, _ = self.machine.set_up("build")
        self.assertEqual(code, 1)
        self.assertIn("apt-get install --no-install-recommends nodejs npm", err)
        self.assertIn("v12.22.9", err)
        # As root: apt-get has nothing younger, which is not taken for success.
        self.machine.user(0)
        code, _, err, _ = self.machine.set_up("build")
        self.assertEqual(code, 1)
        self.assertIn("too old", err)

    def test_the_environment_of_python_is_made_last(self):
        script = os.path.join(self.machine.folder, "tree/.ci/python-venv")
        with open(script, "w", encoding="utf-8") as out:
            out.write(f'#!{shutil.which("bash")}\necho environment $*\nexit 7\n')
        os.chmod(script, 0o755)
        self.assertEqual(self.machine.set_up("build"), (0, "", "", []))
        self.assertEqual(self.machine.set_up("build", "python"), (7, "environment\n", "", []))
        self.assertEqual(self.machine.set_up("build", "python", "site"), (7, "environment site\n", "", []))
        # Without what is optional it is made all the same; without what is needed it is not.
        self.machine.remove("ccache")
        code, out, err, _ = self.machine.set_up("build", "python")
        self.assertEqual((code, out, err.count("\n")), (7, "environment\n", 1))
        self.machine.command("python3", "exit 1")
        code, out, err, _ = self.machine.set_up("python")
        self.assertEqual((code, out), (1, ""))
        self.assertIn("apt-get install --no-install-recommends python3-dev python3-venv", err)

    def test_a_job_that_does_not_exist_is_an_error_of_use(self):
        self.assertEqual(self.machine.set_up("bogus")[0], 2)
        self.assertEqual(self.machine.set_up()[0], 2)


if __name__ == "__main__":
    unittest.main()
