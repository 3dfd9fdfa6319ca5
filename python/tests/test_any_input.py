"""Whatever array comes in: an answer, or an exception that says what was expected. Never a crash, never another answer for
the same numbers in another layout."""
import warnings

import numpy
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

import abbe
from test_bad_input import ERRORS, MILL, MODEL, PLANE, TAKES_COMMANDS, TAKES_POINTS

pytestmark = pytest.mark.bad_input  # also run under the address sanitizer (CMakeLists.txt)

ANSWERS = (abbe.InputError, TypeError, ValueError, OverflowError)
FROZEN = abbe.FrozenCompensation(abbe.freeze(ERRORS).bytes)

TAKES_ARRAYS = {
    **TAKES_COMMANDS,
    **{f"points: {name}": function for name, function in TAKES_POINTS.items()},
    "targets": lambda array: abbe.inverse(MILL, array),
    "directions": lambda array: abbe.inverse(MILL, [[0, 0, 0]], directions=array),
    "rotations": lambda array: abbe.inverse(MILL, [[0, 0, 0]], rotations=array),
    "evaluate": lambda array: ERRORS.evaluate("X", array),
    "evaluate_uncertainty": lambda array: ERRORS.evaluate_uncertainty("X", array),
    "covariance": lambda array: setattr(ERRORS.copy(), "covariance", array),
    "values": lambda array: setattr(ERRORS.copy(), "values_mm_rad", array),
    "coefficients": lambda array: abbe.Errors(MILL).add_motion("EXX", coefficients_um=array),
    "triangles": lambda array: abbe.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], array),
    "rotation_xyz": abbe.rotation_xyz,
    "angles_xyz": abbe.angles_xyz,
    "out": lambda array: MODEL.poses(numpy.zeros((3, 4)), out=array),
    "correct_commands": lambda array: abbe.correct_commands(ERRORS, array),
    "evaluate_circular": lambda array: abbe.evaluate_circular({"angle_deg": array, "deviation_um": array}, radius_mm=100),
    "evaluate_straightness": lambda array: abbe.evaluate_straightness({"position_mm": array, "deviation_um": array}),
    "evaluate_etve": lambda array: abbe.evaluate_etve({"time_s": array, "X_um": array, "air_degC": array}),
    "frozen": FROZEN.correct,
    "tool of frozen": lambda array: FROZEN.correct(numpy.zeros((2, 4)), tool_mm=array),
    "frozen bytes": lambda array: abbe.FrozenCompensation(array.tobytes()),
}

SHAPES = st.one_of(arrays.array_shapes(min_dims=0, max_dims=4, min_side=0, max_side=5),
                   st.tuples(st.integers(0, 40), st.sampled_from([3, 4])))
EDGES = st.sampled_from([0.0, -0.0, 1.0, numpy.nan, numpy.inf, -numpy.inf, 1e308, -1e308, 5e-324, 1e16, numpy.pi])
NUMBERS = st.one_of(st.floats(-1e3, 1e3), EDGES, st.floats())
DTYPES = st.one_of(arrays.floating_dtypes(), arrays.integer_dtypes(), arrays.boolean_dtypes(), arrays.complex_number_dtypes(),
                   arrays.unicode_string_dtypes(max_len=3), arrays.datetime64_dtypes())


@st.composite
def any_array(draw):
    """float64 mostly; layouts of all kinds."""
    if draw(st.integers(0, 3)) == 0:
        array = draw(arrays.arrays(draw(DTYPES), draw(SHAPES)))
    else:
        array = draw(arrays.arrays(numpy.float64, draw(SHAPES), elements=NUMBERS))
    layout = draw(st.integers(0, 5))
    if layout == 1:
        array = numpy.asfortranarray(array)
    elif layout == 2:
        array = array.T
    elif layout == 3 and array.ndim:
        array = array[::-1]
    elif layout == 4 and array.ndim:
        array = numpy.repeat(array, 2, axis=-1)[..., ::2]
    elif layout == 5 and array.dtype.kind == "f":
        array = array.astype(array.dtype.newbyteorder())
    return array


@pytest.mark.parametrize("function", TAKES_ARRAYS)
@settings(max_examples=60, deadline=None, derandomize=True, database=None, suppress_health_check=list(HealthCheck))
@given(array=any_array())
def test_any_array(function, array):
    before = array.copy()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of NumPy, when complex or huge numbers are converted
        try:
            TAKES_ARRAYS[function](array)
        except ANSWERS as error:
            assert str(error)
    if function != "out":
        assert before.tobytes() == array.tobytes()  # inputs are never touched


@settings(max_examples=60, deadline=None, derandomize=True, database=None, suppress_health_check=list(HealthCheck))
@given(array=arrays.arrays(numpy.float64, st.tuples(st.integers(1, 40), st.just(4)), elements=st.floats(-300, 300)),
       layout=st.sampled_from([numpy.asfortranarray, lambda a: a[::-1].copy()[::-1], lambda a: numpy.repeat(a, 3, 1)[:, ::3],
                               lambda a: a.astype(">f8"), numpy.ndarray.tolist]))
def test_a_layout_does_not_change_a_bit(array, layout):
    same = layout(array)
    for name in ("poses", "nominal_poses"):
        expected, result = getattr(MODEL, name)(array), getattr(MODEL, name)(same)
        assert numpy.array_equal(expected.points_mm, result.points_mm)
        assert numpy.array_equal(expected.rotations, result.rotations)
    assert numpy.array_equal(MODEL.deviations(array), MODEL.deviations(same))
    assert numpy.array_equal(abbe.CompensatedInverse(ERRORS).correct(array).positions_mm_rad,
                             abbe.CompensatedInverse(ERRORS).correct(same).positions_mm_rad)
    points = array[:, :3]
    assert numpy.array_equal(PLANE.distances(points), PLANE.distances(numpy.array(same)[:, :3]))
