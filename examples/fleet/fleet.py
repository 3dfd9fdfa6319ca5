#!/usr/bin/env python3
"""A fleet of simulated machines over a year: which need service?

    python3 fleet.py run FOLDER                     two Dask workers on this computer
    python3 fleet.py run FOLDER --scheduler tcp://host:8786
    python3 fleet.py shard FOLDER --index 3         one shard without Dask, such as a task of a Slurm array
    python3 fleet.py page FOLDER                    gathers the shards: machines.json, score.json, index.html

Done work is not done again: start the same command again after a kill. README.md says what is in the folder.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import time
from dataclasses import fields
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))

from page import page_html  # noqa: E402
from scoring import score_fleet  # noqa: E402
from shards import Settings, claim, do_shard, gather, json_text, rows_of, shard_path, write_atomically  # noqa: E402


def shard_task(folder: str, settings: Settings, shard: int) -> int:
    """What a worker runs; it imports this folder by itself."""
    return do_shard(Path(folder), settings, shard)


def run_with_dask(folder: Path, settings: Settings, workers: int, scheduler: str | None) -> int:
    from dask.distributed import Client, LocalCluster, as_completed

    todo = [shard for shard in settings.shards() if not shard_path(folder, shard).exists()]
    print(f"{len(settings.shards()) - len(todo)} of {len(settings.shards())} shards are done already", flush=True)
    if not todo:
        return 0
    cluster = None if scheduler else LocalCluster(n_workers=workers, threads_per_worker=1, processes=True,
                                                  dashboard_address=None)
    added = 0
    begin = time.perf_counter()
    with Client(scheduler or cluster) as client:
        # Tasks of a worker that dies run again elsewhere; three deaths of one task are taken for its fault.
        futures = client.map(shard_task, [str(folder)] * len(todo), [settings] * len(todo), todo, pure=False)
        for done, future in enumerate(as_completed(futures), 1):
            added += future.result()
            spent = time.perf_counter() - begin
            print(f"{done} of {len(todo)} shards, {added} campaigns added, {spent:.0f} s", flush=True)
    if cluster:
        cluster.close()
    wall = {"wall_s": time.perf_counter() - begin, "campaigns": added, "workers": workers if not scheduler else None}
    write_atomically(folder / "times" / f"run-{time.time_ns()}.json", json_text(wall))
    return added


def write_page(folder: Path, settings: Settings, with_times: bool) -> None:
    rows = gather(folder, settings)
    truth = [row for shard in settings.shards()
             for row in rows_of(folder / "truth" / shard_path(folder, shard).name)]
    score = score_fleet(settings, rows, truth)
    times = []
    if with_times:
        times = [json.loads(path.read_text()) for path in sorted((folder / "times").glob("*.json"))]
    write_atomically(folder / "machines.json", json_text(rows))
    write_atomically(folder / "score.json", json_text(score))
    write_atomically(folder / "index.html", page_html(settings, rows, score, times))
    alarms = score["false_alarms"]
    print(f"{score['alarms']} of {settings.machines} machines need service; false alarms {alarms['machines']} of "
          f"{alarms['of']} without an event ({100 * alarms['share']:.2f} %, expected {100 * alarms['expected']:.2f} %)")
    print(f"{folder / 'index.html'}")


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("step", choices=["run", "shard", "page"])
    parser.add_argument("folder", type=Path)
    for field in fields(Settings):
        kind = int if isinstance(field.default, int) else float
        parser.add_argument("--" + field.name.replace("_", "-"), type=kind, default=field.default)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--scheduler", help="address of a Dask scheduler; default: workers on this computer")
    parser.add_argument("--index", type=int, help="of the shard; default: SLURM_ARRAY_TASK_ID")
    parser.add_argument("--no-times", action="store_true", help="a page without times, which differ from run to run")
    given = parser.parse_args()
    if given.machines < 1 or given.weeks < 2 or given.shard < 1 or given.workers < 1:
        parser.error("expected at least one machine, two weeks, one machine in a shard and one worker")
    if not 0 <= given.share_with_event <= 1 or not 0 < given.false_alarms < 0.5 or not 0 < given.weight <= 1:
        parser.error("expected 0 <= share with event <= 1, 0 < false alarms < 0.5, 0 < weight <= 1")
    return given


def main() -> int:
    given = arguments()
    folder = given.folder.resolve()
    settings = Settings(**{field.name: getattr(given, field.name) for field in fields(Settings)})
    if given.step == "page":
        if not (folder / "fleet.json").exists():
            raise SystemExit(f"fleet: {folder} holds no fleet; expected the folder of an earlier run")
        settings = Settings(**json.loads((folder / "fleet.json").read_text()))
        write_page(folder, settings, not given.no_times)
        return 0
    claim(folder, settings)
    if given.step == "run":
        # Workers are processes of their own and find the modules by this path.
        os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, [str(HERE), os.environ.get("PYTHONPATH")]))
        run_with_dask(folder, settings, given.workers, given.scheduler)
        write_page(folder, settings, not given.no_times)
        return 0
    index = given.index if given.index is not None else int(os.environ.get("SLURM_ARRAY_TASK_ID", "-1"))
    if index not in settings.shards():
        raise SystemExit(f"fleet: shard {index}; expected --index 0 to {len(settings.shards()) - 1}")
    print(f"shard {index}: {do_shard(folder, settings, index)} campaigns added")
    return 0


if __name__ == "__main__":
    sys.exit(main())
