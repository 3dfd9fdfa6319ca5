"""Arguments that make no sense end in an exception that says so; those that are only unusual give what usual ones give."""
import numpy
import pytest

import abbe

pytestmark = pytest.mark.bad_input  # also run under the address sanitizer (CMakeLists.txt)

MILL = abbe.Machine.from_chain("w C' X' Y' b Z t")
ERRORS = abbe.Errors(MILL)
ERRORS.add_location("EC0Y", value_urad=20)
MODEL = abbe.PoseModel(ERRORS)
INVERSE = abbe.CompensatedInverse(ERRORS)

TAKES_COMMANDS = {
    "poses": MODEL.poses,
    "nominal_poses": MODEL.nominal_poses,
    "points": MODEL.points,
    "covered": MODEL.covered,
    "deviations": MODEL.deviations,
    "jacobian": MODEL.jacobian,
    "jacobian_by_positions": MODEL.jacobian_by_positions,
    "abbe.nominal_poses": lambda commands: abbe.nominal_poses(MILL, commands),
    "correct": INVERSE.correct,
    "reach": lambda commands: INVERSE.reach(commands, [[0, 0, 0]]),
    "inverse start": lambda commands: abbe.inverse(MILL, [[0, 0, 0]], start_mm_rad=commands),
}
BAD_COMMANDS = {
    "no number": "no number",
    "None": None,
    "0-d": numpy.array(1.0),
    "a number": 1.0,
    "too few axes": numpy.zeros((5, 3)),
    "too many axes": numpy.zeros(5),
    "three dimensions": numpy.zeros((2, 2, 4)),
    "no axes": numpy.zeros((3, 0)),
    "nan": [[0, 0, numpy.nan, 0]],
    "infinity": numpy.full((2000, 4), numpy.inf),
    "complex": numpy.zeros((2, 4), dtype=complex),
    "texts": [["0", "0", "0", "0"]],
    "objects": numpy.array([[object()] * 4]),
    "ragged": [[0, 0, 0, 0], [0, 0]],
    "dates": numpy.zeros((2, 4), dtype="datetime64[s]"),
    "records": numpy.zeros(4, dtype=[("a", float), ("b", int)]),
    "dictionary": {"X": 1},
    "itself": MILL,
}


@pytest.mark.parametrize("bad", BAD_COMMANDS)
@pytest.mark.parametrize("function", TAKES_COMMANDS)
def test_bad_commands(function, bad):
    if function == "inverse start" and bad == "None":
        return  # no start
    with pytest.raises((abbe.InputError, TypeError)) as raised:
        TAKES_COMMANDS[function](BAD_COMMANDS[bad])
    assert str(raised.value)


TRIANGLE = abbe.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
PLANE = abbe.Shape("plane", [0, 0, 0], [0, 0, 1])
TAKES_POINTS = {
    "PointCloud": abbe.PointCloud,
    "PointCloud normals": lambda points: abbe.PointCloud(numpy.zeros((2, 3)), points),
    "Mesh": lambda points: abbe.Mesh(points, [[0, 0, 0]]),
    "closest": TRIANGLE.closest,
    "distances": PLANE.distances,
    "fit": lambda points: abbe.fit(points, "sphere"),
    "fit_coaxial_circles": lambda points: abbe.fit_coaxial_circles([points]),
    "best_fit_transform source": lambda points: abbe.best_fit_transform(points, numpy.zeros((2, 3))),
    "best_fit_transform target": lambda points: abbe.best_fit_transform(numpy.zeros((2, 3)), points),
    "register_scan": lambda points: abbe.register_scan(points, TRIANGLE),
    "register_to_features": lambda points: abbe.register_to_features(points, [PLANE]),
    "scan_deviations": lambda points: abbe.scan_deviations(points, TRIANGLE),
    "evaluate_contour": lambda points: abbe.evaluate_contour(points, abbe.Curve([[0, 0, 0], [1, 0, 0]])),
}
BAD_POINTS = {
    "None": None, "0-d": numpy.array(1.0), "a number": 1.0, "one point": [0, 0, 0], "two columns": numpy.zeros((5, 2)),
    "four columns": numpy.zeros((5, 4)), "three dimensions": numpy.zeros((2, 2, 3)), "no columns": numpy.zeros((3, 0)),
    "nan": [[0, 0, numpy.nan]] * 2, "infinity": numpy.full((3000, 3), numpy.inf), "huge": [[1e300, 0, 0]] * 2,
    "complex": numpy.zeros((2, 3), complex), "texts": [["0", "0", "0"]] * 2, "objects": numpy.array([[object()] * 3]),
    "ragged": [[0, 0, 0], [0, 0]], "dates": numpy.zeros((2, 3), "datetime64[s]"), "dictionary": {"x": 1},
    "records": numpy.zeros(3, dtype=[("a", float), ("b", int)]), "itself": MILL, "a missing file": "/nowhere/points.csv",
    "a name with a zero": "a\0b", "a surrogate": "\udcff",
}


@pytest.mark.parametrize("bad", BAD_POINTS)
@pytest.mark.parametrize("function", TAKES_POINTS)
def test_bad_points(function, bad):
    if function == "PointCloud normals" and bad == "None":
        return  # there are none
    with pytest.raises((abbe.InputError, TypeError, ValueError)) as raised:
        TAKES_POINTS[function](BAD_POINTS[bad])
    assert str(raised.value)


@pytest.mark.parametrize("count", [1, 2, 513, 3000])
def test_unusual_points(count):
    points = numpy.random.default_rng(1).uniform(-100, 100, (count, 3))
    expected = TRIANGLE.closest(points).distance_mm
    for name, same in unusual_points(points):
        assert numpy.array_equal(TRIANGLE.closest(same).distance_mm, expected), name
        assert numpy.array_equal(abbe.PointCloud(same).points_mm, points), name


def unusual_points(points):
    """The same numbers in other ways."""
    padded = numpy.zeros((2 * len(points), 9))
    padded[::2, 1:7:2] = points
    yield "every second", padded[::2, 1:7:2]
    yield "backwards", points[::-1, ::-1].copy()[::-1, ::-1]
    yield "Fortran order", numpy.asfortranarray(points)
    yield "other byte order", points.astype(">f8")
    yield "lists", points.tolist()


def unusual(commands):
    """The same numbers in other ways."""
    padded = numpy.zeros((2 * len(commands), 9))
    padded[::2, 1::2] = commands
    yield "every second", padded[::2, 1::2]
    yield "backwards", commands[::-1, ::-1].copy()[::-1, ::-1]
    yield "Fortran order", numpy.asfortranarray(commands)
    yield "other byte order", commands.astype(">f8")
    yield "long double", commands.astype(numpy.longdouble)
    yield "lists", commands.tolist()
    read_only = commands.copy()
    read_only.flags.writeable = False
    yield "read-only", read_only
    unaligned = numpy.empty(commands.nbytes + 1, dtype=numpy.uint8)[1:].view(float).reshape(commands.shape)
    unaligned[:] = commands
    yield "unaligned", unaligned


@pytest.mark.parametrize("count", [1, 2, 511, 513, 3000])
def test_unusual_arrays(count):
    commands = numpy.random.default_rng(1).uniform(-100, 100, (count, 4))
    expected = MODEL.deviations(commands)
    for name, same in unusual(commands):
        assert numpy.array_equal(MODEL.deviations(same), expected), name
    one = numpy.broadcast_to(commands[0], (count, 4))  # strides of 0
    assert numpy.array_equal(MODEL.deviations(one), numpy.broadcast_to(expected[0], (count, 6)))


@pytest.mark.parametrize("function", [name for name in TAKES_COMMANDS if name not in ("reach", "inverse start")])
def test_no_commands_give_no_results(function):
    result = TAKES_COMMANDS[function](numpy.zeros((0, 4)))
    for name in ("points_mm", "positions_mm_rad"):
        result = getattr(result, name, result)
    assert len(result) == 0


def test_results_outlive_what_they_came_from():
    commands = numpy.zeros((1000, 4))
    model = abbe.PoseModel(ERRORS)
    poses = model.poses(commands)
    points, covered = poses.points_mm, poses.covered
    del model, poses, commands
    assert points.shape == (1000, 3) and points.sum() == points.sum() and covered.all()


@pytest.mark.parametrize("bad", [[[1, 2]], [1, 2, 3], "text", numpy.zeros((2, 3, 3)), [[1j, 0, 0]]])
def test_bad_targets(bad):
    with pytest.raises((abbe.InputError, TypeError)):
        abbe.inverse(MILL, bad)
    with pytest.raises((abbe.InputError, TypeError)):
        INVERSE.reach(numpy.zeros((1, 4)), bad)
    with pytest.raises((abbe.InputError, TypeError)):
        abbe.inverse(MILL, [[0, 0, 0]], directions=bad)
    with pytest.raises((abbe.InputError, TypeError)):
        abbe.inverse(MILL, [[0, 0, 0]], rotations=bad)


def test_a_target_that_is_not_finite_is_not_reached():
    solutions = abbe.inverse(MILL, [[1, 2, numpy.nan], [1, 2, 3]])
    assert solutions.solved.tolist() == [False, True]
    assert "not finite" in solutions.problems[0] and numpy.isnan(solutions.positions_mm_rad[0]).all()
    corrections = INVERSE.reach(numpy.zeros((2, 4)), [[1, 2, numpy.nan], [1, 2, 3]], directions=[[0, 0, 1]] * 2)
    assert corrections.reached.tolist() == [False, True]


def test_directions_that_are_needed():
    with pytest.raises((abbe.InputError, TypeError)):
        INVERSE.reach(numpy.zeros((1, 4)), [[1, 2, 3]])


def test_rotations_that_are_needed():
    with pytest.raises((abbe.InputError, TypeError)):
        abbe.CompensatedInverse(ERRORS, target="pose").reach(numpy.zeros((1, 4)), [[1, 2, 3]])


@pytest.mark.parametrize("call", [
    lambda: abbe.Machine.from_chain(""),
    lambda: abbe.Machine.from_chain("w \0 b t"),
    lambda: abbe.Machine.parse("axis = 3"),
    lambda: abbe.Machine.parse("\udcff"),
    lambda: abbe.Machine.read("/nowhere/a.machine.toml"),
    lambda: abbe.Machine.read(3),
    lambda: MILL.axis("Q"),
    lambda: setattr(MILL.axes[0], "direction", [1, 2]),
    lambda: setattr(MILL.axes[0], "direction", "X"),
    lambda: abbe.Errors(None),
    lambda: abbe.Errors(3),
    lambda: abbe.Errors(MILL).add_location("EXX", value_um=1),
    lambda: abbe.Errors(MILL).add_motion("EQX", coefficients_um=[1]),
    lambda: abbe.Errors(MILL).add_motion("EXX", coefficients_um=[numpy.nan]),
    lambda: abbe.Errors(MILL).add_location("EC0Y", value_urad=numpy.nan),
    lambda: abbe.Errors(MILL).add_motion("EXX", coefficients_um=[1], range_mm=[0, numpy.inf]),
    lambda: abbe.Errors(MILL).add_motion("EXX", basis="table-linear", coefficients_um=[1, 2], nodes_mm=[0, numpy.nan]),
    lambda: abbe.Errors(MILL).add_motion("EXX", basis="fourier", coefficients_um=[1, 2, 3], period_mm=numpy.inf),
    lambda: abbe.Errors(MILL).add_motion("EXX", basis="bspline", coefficients_um=[]),
    lambda: setattr(abbe.Errors(MILL), "values_mm_rad", [1, 2]),
    lambda: setattr(abbe.Errors(MILL), "covariance", numpy.zeros((2, 3))),
    lambda: abbe.Errors(MILL).evaluate("Q", [0]),
    lambda: ERRORS.evaluate("X", [[0, 1]]),
    lambda: abbe.CompensatedInverse(ERRORS, target="anything"),
    lambda: abbe.CompensatedInverse(ERRORS, hold=["Q"]),
    lambda: abbe.CompensatedInverse(ERRORS, largest_turn_deg=numpy.nan),
    lambda: abbe.PoseModel(MILL),
    lambda: abbe.inverse(MILL, [[0, 0, 0]], hold_mm_rad={"Q": 1}),
    lambda: abbe.instrument("ball-bar", MILL),
    lambda: abbe.instrument("nothing", MILL),
    lambda: abbe.Study(MILL, {}),
    lambda: abbe.Study(MILL, {"setup": 3}),
    lambda: abbe.set_threads(-1),
    lambda: abbe.positions(MILL, X=3),
    lambda: abbe.positions(MILL, X_mm=[1, 2], Y_mm=[1, 2, 3]),
])
def test_bad_arguments(call):
    with pytest.raises((abbe.InputError, TypeError, KeyError, ValueError, OSError)) as raised:
        call()
    assert str(raised.value)


def test_classes_that_cannot_be_made_say_so():
    for kind in (abbe.StudyResult, abbe.StudyPlan, abbe.Instrument, abbe.Poses, abbe.Corrections, abbe.Evaluation,
                 abbe.EvaluationFigure, abbe.FittedShape, abbe.ScanRegistration, abbe.ScanDeviations, abbe.PlannedScan,
                 abbe.ImportedTable, abbe.ImportedColumn, abbe.Comparison, abbe.ComparedPair, abbe.ComparedError,
                 abbe.ComparedCurve):
        with pytest.raises(TypeError):
            kind()


@pytest.mark.filterwarnings("ignore:nanobind")
@pytest.mark.parametrize("call", [
    lambda: abbe.PoseModel.__new__(abbe.PoseModel).points([0]),
    lambda: abbe.Errors.__new__(abbe.Errors).names,
    lambda: abbe.CompensatedInverse.__new__(abbe.CompensatedInverse).correct([0]),
    lambda: abbe.Mesh.__new__(abbe.Mesh).vertices_mm,
    lambda: abbe.Mesh.__new__(abbe.Mesh).triangles,
    lambda: abbe.Mesh.__new__(abbe.Mesh).closest([[0, 0, 0]]),
    lambda: abbe.PointCloud.__new__(abbe.PointCloud).points_mm,
    lambda: abbe.PointCloud.__new__(abbe.PointCloud).normals,
    lambda: abbe.fit(abbe.PointCloud.__new__(abbe.PointCloud), "plane"),
    lambda: abbe.Evaluation.__new__(abbe.Evaluation).numbers,
    lambda: abbe.FittedShape.__new__(abbe.FittedShape).points_mm,
    lambda: abbe.ImportedTable.__new__(abbe.ImportedTable).values(),
    lambda: abbe.ImportedTable.__new__(abbe.ImportedTable).csv(),
    lambda: abbe.Comparison.__new__(abbe.Comparison).pairs,
    lambda: abbe.compare([abbe.Errors.__new__(abbe.Errors)] * 2),
])
def test_an_object_that_was_never_initialised_is_refused(call):
    with pytest.raises(TypeError):
        call()
