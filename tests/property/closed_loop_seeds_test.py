#!/usr/bin/env python3
"""Whether the closed loop leaves the error that it predicts, over machines with different hidden errors.

    tests/property/closed_loop_seeds_test.py ABBE EXAMPLES [SEEDS]

ABBE is the command, EXAMPLES the repository's folder of examples, SEEDS how many machines (default 20). For each, the study
of examples/closed_loop is given other hidden errors and other noise, its readings are simulated and identified, and the
volumetric error at 1000 unseen poses is divided by its predicted standard uncertainty (both root mean square). One ratio
scatters: the errors that are left depend on few weakly seen directions and on the orders chosen. Their mean must be
1.0 +- 0.1, with three times its own standard error beside it. Prints a row for each machine; exit code 1 if the mean is off.
"""
import concurrent.futures
import json
import os
import pathlib
import re
import statistics
import subprocess
import sys
import tempfile

ALLOWED = 0.1


def study_with(text, seed):
    text, once = re.subn(r"^seed = 21$", f"seed = {21 + seed}", text, flags=re.M)
    text, twice = re.subn(r"^seed = 2026$", f"seed = {2026 + seed}", text, flags=re.M)
    if (once, twice) != (1, 1):
        raise SystemExit("the study of the closed loop has other seeds than this test replaces")
    return text


def command(*words):
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True)
    if done.returncode != 0:
        raise SystemExit(f"{' '.join(map(str, words))}: exit code {done.returncode}\n{done.stderr}")
    return done.stdout


def figures(abbe, folder, text, seed):
    study = folder / "closed_loop" / f"seed-{seed}.study.toml"
    study.write_text(study_with(text, seed))
    results = folder / f"seed-{seed}"
    said = command(abbe, "run", study, "-o", results)
    orders = re.search(r"orders chosen at held-out poses: (.*)", said)
    unseen = json.loads(command(abbe, "verify", results, "--json", "--accept-uncovered"))["unseen_poses"]
    return seed, unseen["reduction"], unseen["uncertainty_ratio"], orders.group(1) if orders else ""


def main():
    abbe, examples = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
    seeds = int(sys.argv[3]) if len(sys.argv) > 3 else 20
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / "closed_loop").mkdir()
        (folder / "machines").symlink_to(examples / "machines")
        (folder / "closed_loop" / "poses.csv").symlink_to(examples / "closed_loop" / "poses.csv")
        text = (examples / "closed_loop" / "closed_loop.study.toml").read_text()
        ratios = []
        print("seed  times smaller  times predicted  orders")
        with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
            for seed, reduction, ratio, orders in pool.map(lambda k: figures(abbe, folder, text, k), range(seeds)):
                print(f"{seed:4}  {reduction:13.1f}  {ratio:15.2f}  {orders}", flush=True)
                ratios.append(ratio)
    mean, scatter = statistics.mean(ratios), statistics.stdev(ratios)
    error = scatter / len(ratios) ** 0.5
    print(f"times predicted: mean {mean:.3f} (standard error {error:.3f}), standard deviation {scatter:.3f}, "
          f"largest {max(ratios):.2f}")
    if abs(mean - 1) > ALLOWED + 3 * error:
        print(f"expected: within {ALLOWED} of 1, and three standard errors")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
