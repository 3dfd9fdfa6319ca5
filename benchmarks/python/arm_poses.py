"""Poses of a six-axis arm with errors: the package beside others, and beside NumPy."""

from __future__ import annotations

from arm import Arm, commands, errors_of, poses_by_numpy
from report import Table
from rivals import POSES, WITHOUT_TARGET, missing, version_of
from timing import in_turn, seconds

import abbe

AGREE_MM = 1e-9


def arm_poses(count: int, one_by_one: int, repetitions: int) -> Table:
    """count: for what takes arrays; one_by_one: for what takes one pose after the other."""
    arm = Arm.with_errors()
    q, some = commands(count), commands(one_by_one)
    model = abbe.PoseModel(errors_of(arm))
    poses = model.poses(q)
    points, rotations = poses_by_numpy(arm, q)
    assert abs(points - poses.points_mm).max() < AGREE_MM, "NumPy has other points"
    turned = model.poses(q[:1]).rotations[0].T @ rotations[0]  # the last frame in that of the tool, which is constant
    assert abs(poses.rotations @ turned - rotations).max() < AGREE_MM, "NumPy has other rotations"
    measures = {
        "abbe, poses()": (count, lambda: seconds(lambda: model.poses(q))),
        "abbe, poses(out=)": (count, lambda: seconds(lambda: model.poses(q, out=poses))),
        "NumPy, vectorised": (count, lambda: seconds(lambda: poses_by_numpy(arm, q))),
    }
    table = Table(f"Poses of a six-axis arm with errors, {abbe.threads()} threads of abbe: ns per pose", "ns", "time / abbe, poses()")
    for name, (module, distribution, make) in POSES.items():
        problem = missing(module)
        if problem:
            table.notes.append(f"{name}: not compared, {problem}")
            continue
        compute = make(arm)
        difference = abs(compute(some) - model.points(some)).max()
        assert difference < AGREE_MM, f"{name} has other points: {difference} mm"
        measures[f"{name} {version_of(module, distribution)}".strip()] = (one_by_one, lambda f=compute: seconds(lambda: f(some)))
    times = in_turn({name: measure for name, (_, measure) in measures.items()}, repetitions)
    per_pose = {name: times[name].per(1e-9 * number) for name, (number, _) in measures.items()}
    for name, time in per_pose.items():
        others = not name.startswith(("abbe", "NumPy, vectorised", *WITHOUT_TARGET))
        table.add(name, time, per_pose["abbe, poses()"], at_least=100 if others else None)
    table.notes.append(f"{count:,} poses for abbe and NumPy, {one_by_one:,} for the others, whose positions are taken; they agree to "
                       f"{AGREE_MM:g} mm")
    return table
