#!/usr/bin/env python3
"""Whether two builds of the command give the same bytes: for changes that must not change any result.

    tests/same_bytes.py OLD NEW             paths of two `abbe` commands
    tests/same_bytes.py --no-pdf OLD NEW    without printing to PDF, where one of them finds no browser

Runs the examples of the help texts, those of MORE, the studies of examples/ and the published studies, each in a fresh
copy of the repository's data, and compares exit code, standard output, standard error and all files. If anything
differs, its name is printed and the exit code is 1. The commands look for published readings beside their build folder,
and for abbe-papers and abbe-step beside themselves, so each must be in a build folder of its own.
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


TRUNNION = ("--machine examples/machines/trunnion-mill.machine.toml "
            "--errors examples/compensate/trunnion.errors.toml")
SCANNER = "examples/machines/liu-scanner.machine.toml"
ENGRAVER = "--machine examples/machines/yin-engraver-u.machine.toml"
BRACKET = "examples/scan/bracket-scan.csv examples/scan/bracket.stl"
PIN = "examples/scan/pin-scan.csv examples/scan/pin.stl"
# What the examples of the help texts do not show: JSON, pages, refusals, messages. Lists of commands that share a copy.
FREEZE = ["-o a.abbec --leave-out-below-uncertainty 2 --world workpiece --tool-mm 0 0 -120", "--dry-run --limit-um 1",
          "--dry-run --json --limit-um 1 --leave-out-below-uncertainty 2", "-o b.abbec --limit-um 0",
          "--dry-run --largest-turn-deg 11", "--dry-run --tool-length-mm 300 0",
          "--dry-run --leave-out-below-uncertainty -1", ""]
POSES = ["-o a.csv", "-o b.csv --json --leave-out-below-uncertainty 2", "--dry-run --hold A --hold C",
         "-o c.csv --limit-um 1", "-o d.csv --limit-um 0", "--dry-run --largest-turn-deg 0", "--dry-run --hold Q", ""]
FIT = ["cylinder --method robust --loss huber --residuals r.csv -o results", "cylinder --fixed-direction 0,0,1 --json",
       "cylinder --fixed-radius-mm 12.7 --tolerance form_um=1", "line --fixed-radius-mm 2",
       "sphere --fixed-direction 0,0,1", "line2 --fixed-direction 0,0,1", "plane --fixed-half-angle-deg 3",
       "cone --method inscribed", "circle2 --method inscribed --fixed-radius-mm 3", "cylinder --fixed-radius-mm -1",
       "coaxial-circles --method robust", "coaxial-circles --residuals r2.csv", "plane --fixed-direction 0,0"]
STEPS = "abbe fit examples/fit/step-1.csv examples/fit/step-2.csv --shape"
PATH = ["table-a4.csv --placement examples/laser_engraver/part.placement.toml -o a.nc -o a.csv --report a.html --json",
        "table-a4.csv --report b.html --part examples/parts/wedge.stl --hold C2_deg=10 --start A_deg=20",
        "table-a4.csv --hold C2_deg=10 --start A_deg=20 --start C1_deg=180 --tolerance-um 1", "table-a4.csv -o d.txt",
        "table-a4.csv --errors examples/laser_engraver/linkage.errors.toml -o e.csv", "table-a4.csv --hold Z_mm=0",
        "regions.ngc --retract-mm 20 -o c.mpf --feed-per-minute --decimals 4 --word C1=C", "regions.ngc",
        "regions.ngc --retract-mm 20 --hold C2_deg=3", "table-a4.csv --start A_deg=0"]
PLAN = ["--json", "--along-mm 1e-4", "--beyond-plane-mm 0 0 1 1e6", "--position-mm 0 0 500 --along-mm 5 --between-mm 5"]
MORE = [
    [f"abbe compensate freeze {TRUNNION} -o a.abbec --json", "abbe check a.abbec", "abbe check a.abbec --json"],
    [f"abbe compensate freeze {TRUNNION} {options}" for options in FREEZE],
    [f"abbe compensate poses {TRUNNION} examples/compensate/poses.csv {options}" for options in POSES],
    [f"abbe fit examples/fit/bore.csv --shape {shape} --json -o results/{shape}"
     for shape in ("line2", "line", "plane", "circle2", "circle", "sphere", "cylinder", "cone")],
    [f"abbe fit examples/fit/bore.csv --shape {options}" for options in FIT],
    ["abbe fit examples/scan/pin.stl --shape cylinder --unit inch", f"{STEPS} plane",
     f"{STEPS} coaxial-circles --fixed-radius-mm 1 --json", f"{STEPS} coaxial-circles --json -o circles"],
    [f"abbe register {BRACKET} --json -o results", f"abbe register {BRACKET} --start identity --scan-unit inch",
     f"abbe deviate {BRACKET} --transform results/transform.csv -o deviation"],
    [f"abbe register {PIN} -o pin --uncertainty", f"abbe deviate {PIN} --faces",
     f"abbe deviate {PIN} --largest-mm 1e-9",
     f"abbe deviate {PIN} --transform pin/transform.csv --json --faces-deg 30 --lower-um -10 --upper-um 10 -o pins",
     f"abbe deviate {PIN} --lower-um 10 --upper-um -10"],
    [f"abbe position examples/laser_engraver/scanner.positioning.toml {options}" for options in (
        "--json -o a.placement.toml", "-o b.placement.toml --maps workpiece-to-table", "--maps workpiece-to-table")],
    [f"abbe path {ENGRAVER} examples/laser_engraver/{options}" for options in PATH],
    [f"abbe scan plan examples/cradle_scanner/pyramid.stl --machine {SCANNER} {options}" for options in PLAN],
]


def help_of(abbe, words):
    return subprocess.run([abbe, *words, "--help"], capture_output=True, text=True, check=True).stdout


SECTIONS = {"Subcommands", "Whole studies", "Machines", "Measure", "Identify", "Evaluate", "Compensate", "Verify", "Shapes"}


def is_heading_of_commands(line):
    return line.rstrip().removesuffix(":") in SECTIONS


def examples(abbe, words=()):
    """Example lines of a help text and of those of its subcommands: lists of commands that stand in one text."""
    text = help_of(abbe, words)
    lines, below = [], False
    for line in re.sub(r"\s*\\\n\s+", " ", text).splitlines():
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
        # Which files belong to results is seen from the files. A history says when its campaigns were added.
        if path.is_file() and path.name != ".abbe-results" and path.suffix != ".history":
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
    paths = sys.argv[1:]
    prints = "--no-pdf" not in paths[:1]
    if not prints:
        paths = paths[1:]
    if len(paths) != 2:
        sys.exit(__doc__)
    old, new = (os.path.abspath(path) for path in paths)
    # Some examples use the results of the main study.
    jobs = [[MAIN_STUDY, *lines] if any("/results/" in line for line in lines) else lines for lines in examples(old)]
    jobs += MORE
    studies = sorted(str(path.relative_to(ROOT)) for path in ROOT.glob("examples/*/*.study.toml"))
    jobs += [[f"abbe run {study} -o results"] for study in studies]
    jobs += [[f"abbe reproduce {paper}"] for paper in ("aguado", "liu", "ma", "wang", "yin")]
    if not prints:
        jobs = [[line for line in lines if not re.search(r"--pdf\b|\.pdf\b", line)] for lines in jobs]
        jobs = [lines for lines in jobs if lines]
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
