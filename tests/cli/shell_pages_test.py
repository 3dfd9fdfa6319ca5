#!/usr/bin/env python3
"""Completions and manual pages that the command makes of its own options. Usage: shell_pages_test.py ABBE

Completions are tried in the shells that are installed (bash always), pages in groff and mandoc where they are."""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

ABBE = os.path.abspath(sys.argv.pop(1))


def abbe(*words):
    return subprocess.run([ABBE, *words], capture_output=True, text=True, check=True).stdout


class InAFolder(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.path = pathlib.Path(self.folder.name)
        (self.path / "a.study.toml").touch()
        (self.path / "with space.toml").touch()
        (self.path / "results").mkdir()


class Bash(InAFolder):
    def complete(self, line):
        """What bash offers at the end of a line, which it splits as it does for completion."""
        script = self.path / "completion"
        script.write_text(abbe("completion", "bash"))
        words = [word for word in re.split(r"(=)|\s+", line) if word]
        if line.endswith((" ", "=")):
            words.append("")
        program = f"""
            source {script}
            compopt() {{ :; }}   # there is none outside of a completion
            COMP_WORDS=({" ".join("'" + word + "'" for word in words)})
            COMP_CWORD=$((${{#COMP_WORDS[@]}} - 1))
            _abbe
            printf '%s\\n' "${{COMPREPLY[@]}}"
        """
        done = subprocess.run(["bash", "--norc", "-eu", "-c", program], cwd=self.path, capture_output=True, text=True)
        self.assertEqual(done.stderr, "")
        return sorted(word for word in done.stdout.splitlines() if word)

    def test_subcommands(self):
        self.assertEqual(self.complete("abbe comp"), ["compare", "compensate"])
        self.assertEqual(self.complete("abbe re"), ["register", "reproduce"])
        self.assertEqual(self.complete("abbe compensate t"), ["table"])
        self.assertEqual(self.complete("abbe help compensate fr"), ["freeze"])
        self.assertNotIn("man", self.complete("abbe "))

    def test_options_of_the_command_that_is_typed(self):
        self.assertEqual(self.complete("abbe run --al"), ["--all-values"])
        self.assertEqual(self.complete("abbe compensate table --machine a.toml --detection"), ["--detection-unit-um"])
        self.assertEqual(self.complete("abbe --ver"), ["--version"])
        self.assertEqual(self.complete("abbe map --al"), [])

    def test_words_of_options_and_arguments(self):
        self.assertEqual(self.complete("abbe fit --method in"), ["inscribed"])
        self.assertEqual(self.complete("abbe fit --method=in"), ["inscribed"])
        self.assertEqual(self.complete("abbe fit --unit="), ["inch", "m", "mm"])
        self.assertEqual(self.complete("abbe reproduce "), ["aguado", "liu", "ma", "wang", "yin"])
        self.assertIn("linuxcnc", self.complete("abbe compensate table --for l"))

    def test_files_where_a_value_may_be_one(self):
        self.assertEqual(self.complete("abbe run a"), ["a.study.toml"])
        self.assertEqual(self.complete("abbe run w"), ["with space.toml"])
        self.assertEqual(self.complete("abbe run a.study.toml -o r"), ["results"])
        self.assertEqual(self.complete("abbe fit --threads "), [])


@unittest.skipUnless(shutil.which("fish"), "fish is not installed")
class Fish(InAFolder):
    def complete(self, line):
        (self.path / "completion.fish").write_text(abbe("completion", "fish"))
        done = subprocess.run(["fish", "--no-config", "-c", f"source completion.fish; complete -C '{line}'"], cwd=self.path,
                              capture_output=True, text=True, env={**os.environ, "HOME": str(self.path)})
        self.assertEqual(done.stderr, "")
        return sorted(offer.split("\t")[0] for offer in done.stdout.splitlines())

    def test_commands_options_words_and_files(self):
        self.assertEqual(self.complete("abbe re"), ["register", "reproduce"])
        self.assertEqual(self.complete("abbe compensate ta"), ["table"])
        self.assertEqual(self.complete("abbe run --al"), ["--all-values"])
        self.assertEqual(self.complete("abbe fit --method in"), ["inscribed"])
        self.assertEqual(self.complete("abbe reproduce "), ["aguado", "liu", "ma", "wang", "yin"])
        self.assertEqual(self.complete("abbe run a"), ["a.study.toml"])


@unittest.skipUnless(shutil.which("zsh"), "zsh is not installed")
class Zsh(InAFolder):
    def test_completion_system_takes_it_and_completes(self):
        (self.path / "_abbe").write_text(abbe("completion", "zsh"))
        # A terminal of its own, since zsh completes only where somebody types; `abbe` is what says how it was called.
        program = r"""
            zmodload zsh/zpty
            zpty shell zsh -f -i
            answer() { zpty -w shell "print D\"\"ONE$1"; zpty -r -m shell text "*DONE$1*"; print -r -- "$text"; }
            zpty -w shell 'PS1=; fpath=($PWD $fpath); autoload -Uz compinit; compinit -u -D; abbe() { print "called<$*>"; }'
            answer 1
            number=1
            for line in 'compensate ta' 'run --al' 'fit --method in' 'reproduce li' 'run a.st'; do
              zpty -n -w shell "abbe $line"$'\t'
              sleep 1
              zpty -n -w shell $'\n'
              answer $((++number))
            done
        """
        done = subprocess.run(["zsh", "-f", "-c", program], cwd=self.path, capture_output=True, text=True, timeout=60,
                              env={**os.environ, "TERM": "xterm", "HOME": str(self.path)})
        said = done.stdout + done.stderr
        for words in ("compensate table", "run --all-values", "fit --method inscribed", "reproduce liu", "run a.study.toml"):
            self.assertIn(f"called<{words}>", said)


class Pages(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.pages = {name: abbe("man", *re.sub(r"^abbe-?", "", name).split()) for name in abbe("man", "--list").split()}

    def test_each_command_has_one_with_what_help_says(self):
        self.assertGreater(len(self.pages), 30)
        page = self.pages["abbe-compensate-table"]
        for part in (r"\fB\-\-leave\-out\-below\-uncertainty\fR", ".SH FORMATS", ".SH EXAMPLE", r"\fBabbe\-compensate\fR(1)"):
            self.assertIn(part, page)
        self.assertIn(".SS Whole studies", self.pages["abbe"])
        for name, page in self.pages.items():
            typed = re.search(r"^\.SH SYNOPSIS\n\\fB(.*?)\\fR", page, re.M).group(1).replace("\\-", "-")
            for option in re.findall(r"^  (?:-\w,)?(--[\w-]+)", abbe(*typed.split()[1:], "--help"), re.M):
                self.assertIn(option.replace("-", "\\-"), page, name)

    @unittest.skipUnless(shutil.which("groff"), "groff is not installed")
    def test_groff_has_no_warning(self):
        for name, page in self.pages.items():
            done = subprocess.run(["groff", "-man", "-Tutf8", "-ww", "-K", "utf8"], input=page, capture_output=True, text=True)
            self.assertEqual(done.stderr, "", name)
            self.assertIn("abbe", done.stdout)

    @unittest.skipUnless(shutil.which("mandoc"), "mandoc is not installed")
    def test_mandoc_has_no_warning(self):
        for name, page in self.pages.items():
            done = subprocess.run(["mandoc", "-T", "lint", "-W", "warning"], input=page, capture_output=True, text=True)
            self.assertEqual(done.stdout, "", name)

    def test_what_has_no_page_is_refused(self):
        done = subprocess.run([ABBE, "man", "nonsense"], capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stdout), (2, ""))
        self.assertIn("abbe man --list", done.stderr)


if __name__ == "__main__":
    unittest.main()
