#!/usr/bin/env python3
"""Whether two builds of the command give the same bytes: for changes that must not change any result.

    tests/same_bytes.py OLD NEW          paths of two `abbe` commands

Runs the examples of the help texts, the studies of examples/ and the published studies, each in a fresh copy of the
repository's data, and compares exit code, standard output, standard error and all files. If anything differs, its name is
printed and the exit code is 1. The commands look for published readings beside their build folder, and for abbe-papers and
abbe-step beside themselves, so each must be in a build folder of its own.
"""
import concurrent.futures
import hashlib
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
DATA = ["examples", "tests/golden"]
MAIN_STUDY = "abbe run examples/aguado/aguado.study.toml"


def help_of(abbe, words):
    return subprocess.run([abbe, *words, "--help"], capture_output=True, text=True, check=True).stdout


SECTIONS = {"Subcommands", "Whole studies", "Machines", "Measure", "Identify", "Evaluate", "Compensate", "Verify", "Shapes"}


def is_heading_of_commands(line):
    return line.rstrip().removesuffix(":") in SECTIONS


def examples(abbe, words=()):
    """Example lines of a help text and of those of its subcommands: lists of commands that stand in one text."""
    text = help_of(abbe, words)
    lines, below = [], False
    for line in text.splitlines():
        below = below or line.startswith("Example")
        if below and line.startswith("  abbe "):
            lines.append(re.split(r"\s{3,}", line.strip())[0])
    found = [lines] if lines else []
    in_list = False
    for line in text.splitlines():
        if is_heading_of_commands(line):
            in_list = True
        elif in_list and (match := re.match(r"  (\S+)\s", line)):
            found += examples(abbe, (*words, match.group(1)))
        elif in_list and not line.strip():
            in_list = False
    return found


def digest(folder):
    result = {}
    for path in sorted(folder.rglob("*")):
        # Which files belong to results is seen from the files.
        if path.is_file() and path.name != ".abbe-results":
            result[str(path.relative_to(folder))] = hashlib.sha256(path.read_bytes()).hexdigest()
    return result


def run(abbe, lines):
    """What a list of commands prints and leaves behind."""
    with tempfile.TemporaryDirectory() as folder:
        place = pathlib.Path(folder) / "copy"
        for data in DATA:
            shutil.copytree(ROOT / data, place / data)
        said = []
        for line in lines:
            words = shlex.split(line)
            done = subprocess.run([abbe, *words[1:]], cwd=place, capture_output=True, stdin=subprocess.DEVNULL)
            said += [(line, "exit code", done.returncode), (line, "standard output", done.stdout.replace(folder.encode(), b"")),
                     (line, "standard error", done.stderr.replace(folder.encode(), b""))]
        return said, digest(place)


def compare(old, new, lines):
    """Names of what the two commands print or leave differently."""
    (old_said, old_files), (new_said, new_files) = run(old, lines), run(new, lines)
    differences = [f"{line}: {what}" for (line, what, was), (_, _, now) in zip(old_said, new_said) if was != now]
    differences += [f"{lines[0]} ...: file {name}" for name in sorted(old_files.keys() | new_files.keys())
                    if old_files.get(name) != new_files.get(name)]
    return differences


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    old, new = (os.path.abspath(path) for path in sys.argv[1:])
    # Some examples use the results of the main study.
    jobs = [[MAIN_STUDY, *lines] if any("/results/" in line for line in lines) else lines for lines in examples(old)]
    studies = sorted(str(path.relative_to(ROOT)) for path in ROOT.glob("examples/*/*.study.toml"))
    jobs += [[f"abbe run {study} -o results"] for study in studies]
    jobs += [[f"abbe reproduce {paper}"] for paper in ("aguado", "liu", "ma", "wang", "yin")]
    differences, commands = [], 0
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for lines, found in zip(jobs, pool.map(lambda job: compare(old, new, job), jobs)):
            commands += len(lines)
            differences += found
            for line in found:
                print(line, flush=True)
    print(f"{commands} commands, {len(differences)} differences")
    sys.exit(1 if differences or commands == 0 else 0)


if __name__ == "__main__":
    main()
