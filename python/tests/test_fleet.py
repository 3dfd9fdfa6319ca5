"""The fleet of examples/fleet: same bytes with any number of workers, killed and resumed, twice at once, by Slurm."""

import json
import math
import os
import resource
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy
import pytest

from local_slurm import LocalSlurm, missing_programs

FLEET = Path(os.environ.get("ABBE_SOURCE_DIR", Path(__file__).resolve().parents[2])) / "examples" / "fleet"
sys.path.insert(0, str(FLEET))
import control  # noqa: E402

SMALL = ["--machines", "12", "--weeks", "10", "--shard", "3", "--share-with-event", "0.5"]
RESULTS = ["machines.json", "score.json", "index.html"]


def fleet(step, folder, *options, check=True):
    return subprocess.run([sys.executable, FLEET / "fleet.py", step, folder, *options], check=check, capture_output=True, text=True)


def results(folder):
    found = {name: (folder / name).read_bytes() for name in RESULTS}
    return found | {path.name: path.read_bytes() for path in sorted((folder / "shards").glob("*.json"))}


@pytest.fixture(scope="module")
def serial(tmp_path_factory):
    """One shard after the other in one process each, without Dask."""
    folder = tmp_path_factory.mktemp("serial")
    for shard in range(4):
        fleet("shard", folder, "--index", str(shard), *SMALL)
    fleet("page", folder, "--no-times")
    return results(folder)


def campaigns_of(folder):
    """A history that was killed while it was made is an empty file."""
    import abbe
    return {path.relative_to(folder).as_posix(): [str(one.date) for one in abbe.History(path).campaigns()]
            for path in sorted((folder / "histories").glob("*/*.history")) if path.stat().st_size > 0}


def assert_nothing_lost_or_twice(folder):
    found = campaigns_of(folder)
    assert len(found) == 24
    for name, dates in found.items():
        assert len(dates) == len(set(dates)) == (10 if name.startswith("histories/ball-bar") else 3), name


def test_limits_are_those_of_simulated_charts():
    rng = numpy.random.default_rng(5)
    limit = control.limit_for(6, 20, 0.25, 0.05)
    above = 0
    for _ in range(20):
        z = rng.normal(size=(1000, 20, 6))
        above += sum(control.averages(each, 0.25).max() > limit for each in z)
    assert abs(above / 20000 - 0.05) < 4 * math.sqrt(0.05 * 0.95 / 20000)


def test_innovations_of_a_random_walk_are_white():
    rng = numpy.random.default_rng(6)
    days = numpy.cumsum(rng.integers(3, 20, size=4000))
    q, r = numpy.array([[0.02, 0.01], [0.01, 0.03]]), numpy.array([[0.5, -0.2], [-0.2, 0.4]])
    walk = numpy.cumsum([numpy.linalg.cholesky(q) @ rng.normal(size=2) * math.sqrt(d) for d in numpy.diff(days, prepend=0)], axis=0)
    y = walk + rng.normal(size=(4000, 2)) @ numpy.linalg.cholesky(r).T
    z = control.innovations(y, numpy.broadcast_to(r, (4000, 2, 2)), q, days)
    assert numpy.abs(numpy.cov(z.T) - numpy.eye(2)).max() < 0.1
    assert numpy.abs(z[1:].T @ z[:-1] / len(z)).max() < 0.07
    # A wrong drift shows.
    assert numpy.cov(control.innovations(y, numpy.broadcast_to(r, (4000, 2, 2)), q / 9, days).T)[0, 0] > 1.3


def test_an_alarm_names_the_campaign_before_the_change():
    assert control.first_alarm(numpy.array([1.0, 2, 1, 3, 9, 9]), 5, 4) == control.Alarm(5, 3)
    assert control.first_alarm(numpy.array([1.0, 2]), 5, 4) is None


def test_the_interval_is_that_of_clopper_and_pearson():
    low, high = control.binomial_interval(3, 50)
    assert abs(low - 0.01255) < 1e-5 and abs(high - 0.16548) < 1e-5
    assert control.binomial_interval(0, 10)[0] == 0 and control.binomial_interval(10, 10)[1] == 1


def test_one_and_two_workers_give_the_same_bytes(serial, tmp_path):
    pytest.importorskip("dask.distributed", reason="pip install -r examples/fleet/requirements.txt")
    for workers in "12":
        fleet("run", tmp_path / workers, "--workers", workers, "--no-times", *SMALL)
        assert results(tmp_path / workers) == serial
        assert_nothing_lost_or_twice(tmp_path / workers)


def test_killed_and_resumed(serial, tmp_path):
    process = subprocess.Popen([sys.executable, FLEET / "fleet.py", "shard", tmp_path, "--index", "0", *SMALL])
    end = time.monotonic() + 60
    while not list(tmp_path.glob("histories/*/00002.history")) and time.monotonic() < end:
        time.sleep(0.002)
    process.send_signal(signal.SIGKILL)
    process.wait()
    assert not (tmp_path / "shards" / "shard-0000.json").exists()
    before = fleet("page", tmp_path, check=False)
    assert before.returncode == 1 and "4 of 4 shards are not done" in before.stderr
    done = {path: campaigns for path, campaigns in campaigns_of(tmp_path).items() if campaigns}
    resumed = fleet("shard", tmp_path, "--index", "0", *SMALL)
    added = int(resumed.stdout.split()[2])
    assert 0 < sum(map(len, done.values())) and added == 39 - sum(map(len, done.values()))
    for shard in "123":
        fleet("shard", tmp_path, "--index", shard, *SMALL)
    fleet("page", tmp_path, "--no-times")
    assert results(tmp_path) == serial
    assert_nothing_lost_or_twice(tmp_path)
    assert "0 campaigns added" in fleet("shard", tmp_path, "--index", "0", *SMALL).stdout


def test_a_killed_worker_of_dask(serial, tmp_path):
    pytest.importorskip("dask.distributed", reason="pip install -r examples/fleet/requirements.txt")
    process = subprocess.Popen([sys.executable, FLEET / "fleet.py", "run", tmp_path, "--no-times", *SMALL],
                               stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    end = time.monotonic() + 60
    while len(list(tmp_path.glob("histories/ball-bar/*.history"))) < 2 and time.monotonic() < end:
        time.sleep(0.005)
    pids = {int(pid) for path in Path(f"/proc/{process.pid}/task").glob("*/children") for pid in path.read_text().split()}
    workers = [pid for pid in pids if "spawn_main" in Path(f"/proc/{pid}/cmdline").read_text()]
    assert workers, pids
    os.kill(workers[0], signal.SIGKILL)
    out, err = process.communicate(timeout=200)
    assert process.returncode == 0, err
    assert results(tmp_path) == serial
    assert_nothing_lost_or_twice(tmp_path)


def test_two_jobs_on_one_folder_and_a_duplicate_shard(serial, tmp_path):
    command = [sys.executable, FLEET / "fleet.py", "shard", tmp_path, *SMALL, "--index"]
    both = [subprocess.Popen(command + ["0"]), subprocess.Popen(command + ["0"])]
    assert [process.wait(200) for process in both] == [0, 0]
    for shard in "123":
        fleet("shard", tmp_path, "--index", shard, *SMALL)
    fleet("page", tmp_path, "--no-times")
    assert results(tmp_path) == serial
    assert_nothing_lost_or_twice(tmp_path)
    other = fleet("shard", tmp_path, "--index", "0", *SMALL, "--seed", "2", check=False)
    assert other.returncode == 1 and "is of another fleet" in other.stderr
    # A shard that holds machines of another is not counted.
    shards = tmp_path / "shards"
    (shards / "shard-0001.json").write_bytes((shards / "shard-0000.json").read_bytes())
    twice = fleet("page", tmp_path, check=False)
    assert twice.returncode == 1 and "exactly once" in twice.stderr


def test_a_truncated_shard_is_refused_and_made_again_from_the_histories(serial, tmp_path):
    for shard in "0123":
        fleet("shard", tmp_path, "--index", shard, *SMALL)
    for folder in ("shards", "truth"):
        path = tmp_path / folder / "shard-0002.json"
        path.write_bytes(path.read_bytes()[:-100])
        refused = fleet("page", tmp_path, check=False)
        assert refused.returncode == 1 and f"{folder}/shard-0002.json cannot be read" in refused.stderr
        assert not (tmp_path / "machines.json").exists()
        (tmp_path / "shards" / "shard-0002.json").unlink()
        assert "0 campaigns added" in fleet("shard", tmp_path, "--index", "2", *SMALL).stdout
    fleet("page", tmp_path, "--no-times")
    assert results(tmp_path) == serial
    assert_nothing_lost_or_twice(tmp_path)


def test_a_full_disk_ends_a_shard_and_the_next_job_adds_the_rest(serial, tmp_path):
    def small_files():
        resource.setrlimit(resource.RLIMIT_FSIZE, (50000, 50000))
    command = [sys.executable, FLEET / "fleet.py", "shard", tmp_path, "--index", "1", *SMALL]
    full = subprocess.run(command, preexec_fn=small_files, check=False, capture_output=True, text=True)
    assert full.returncode != 0 and "InputError" in full.stderr, full.stderr
    assert not list((tmp_path / "shards").glob("*"))
    for dates in campaigns_of(tmp_path).values():
        assert len(dates) in (0, 3, 10)  # all campaigns of a history, or none
    for shard in "0123":
        fleet("shard", tmp_path, "--index", shard, *SMALL)
    fleet("page", tmp_path, "--no-times")
    assert results(tmp_path) == serial
    assert_nothing_lost_or_twice(tmp_path)


def test_an_instrument_answers_to_errors_that_its_study_does_not_identify():
    import abbe
    import campaigns
    import machines
    mill = abbe.Machine.read(machines.MACHINE)
    for kind in campaigns.KINDS:
        found = dict(zip(kind.followed, campaigns.responses(mill, kind)))
        for name, row in found.items():
            own = {"EXX[P1]": "scale X", "EYY[P1]": "scale Y", "EZZ[P1]": "scale Z"}.get(name)
            own = own or ("bend " + name[:3] if name.endswith("[P2]") else name.replace("_", " "))
            unit = 1e-3 if name.endswith("[P2]") or name.startswith("reversal") else 1e-6
            assert abs(row[machines.NAMES.index(own)] / unit - 1) < 0.02, (kind.name, name)
    # The arc in YZ stands below the middle of the travel of Z, where its parabola (P2) has a slope. By hand: of the
    # radial deviation cos(a) P2, which is odd about the vertical, a shift of the ball and a squareness are fitted.
    bar = dict(zip(campaigns.KINDS[0].followed, campaigns.responses(mill, campaigns.KINDS[0])))
    angle = numpy.radians(numpy.linspace(-10, 190, 21))
    height = -340 + 150 * numpy.sin(angle)
    parabola = 1.5 * ((height + 230) / 230) ** 2 - 0.5
    columns = numpy.array([numpy.cos(angle), 150 * numpy.sin(angle) * numpy.cos(angle)]).T
    slope = numpy.linalg.lstsq(columns, numpy.cos(angle) * parabola, rcond=None)[0][1] * 1e-3
    found = bar["EA0Z"][machines.NAMES.index("bend EYZ")]
    assert abs(slope) > 2e-6 and abs(abs(found / slope) - 1) < 0.02, (found, slope)


def test_slurm(serial, tmp_path):
    missing = missing_programs()
    if missing:
        pytest.skip(f"not installed: {' '.join(missing)} (Debian: slurmctld slurmd slurm-client munge)")
    folder = tmp_path / "fleet"
    (tmp_path / "slurm").mkdir()
    with LocalSlurm(tmp_path / "slurm") as slurm:
        environment = slurm.environment | {"PYTHON": sys.executable}
        submitted = subprocess.run([FLEET / "submit", folder, "4", *SMALL], env=environment, capture_output=True, text=True)
        assert submitted.returncode == 0, submitted.stderr
        slurm.wait_for_jobs()
        # The same once more adds nothing.
        subprocess.run([FLEET / "submit", folder, "4", *SMALL], env=environment, check=True, capture_output=True)
        slurm.wait_for_jobs()
    logs = "\n".join(path.read_text() for path in (folder / "logs").glob("*.txt"))
    assert (folder / "index.html").exists(), logs
    assert logs.count("0 campaigns added") == 4 and logs.count("machines need service") == 2, logs
    fleet("page", folder, "--no-times")
    assert results(folder) == serial
    assert_nothing_lost_or_twice(folder)
    assert json.loads((folder / "score.json").read_text())["false_alarms"]["of"] > 0
