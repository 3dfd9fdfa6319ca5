"""Readings of a study before and after an identification: checked against the nominal machine, and against identified errors."""

import json
import os
import signal
import threading

import abbe
import numpy
import pytest
from use_examples import EXAMPLES, command, machine, trunnion

#: Also run under the address sanitizer (CMakeLists.txt).
bad_input = pytest.mark.bad_input

TRACKER = EXAMPLES / "verify/second-tracker.study.toml"
ERRORS = EXAMPLES / "compensate/trunnion.errors.toml"


def second_tracker():
    return abbe.Study.read(TRACKER)


def with_known_offset():
    """The same study; while an offset is open, only mistakes that are found are reported."""
    document = second_tracker().to_dict()
    document["setup"][0]["reflector"][0]["estimate_offset"] = False
    return abbe.Study(second_tracker().machine, document, folder=TRACKER.parent)


def spoiled(study, change):
    """Readings of the example; `change` gets copies of commands and measured numbers, and returns both."""
    of_file = study.gather()["tracker"]
    commands, measured = change(of_file.positions_mm_rad.copy(), of_file.measured_mm_rad.copy())
    return {"tracker": abbe.Readings(of_file.instrument, commands, measured, items=of_file.items[:len(commands)])}


# Verification by readings.

@pytest.mark.parametrize("options, arguments, exit_code", [
    ([], {}, 0), (["--least-reduction", 3, "--largest-ratio", 1.5], {"least_reduction": 3, "largest_ratio": 1.5}, 0),
    (["--least-reduction", 100], {"least_reduction": 100}, 1),
])
def test_a_verification_is_that_of_the_command(options, arguments, exit_code, tmp_path):
    steps = []
    result = second_tracker().verify(trunnion(), **arguments, errors_file=str(ERRORS),
                                     progress=lambda *step: steps.append(step))
    asked = ["verify", "--errors", ERRORS, "--readings", TRACKER, *options]
    assert result.text() + "\npage: page.html\n" == command([*asked, "-o", "page.html"], tmp_path, exit_code)
    assert result.json_text() == command([*asked, "--json"], tmp_path, exit_code)
    assert result.page_html() == (tmp_path / "page.html").read_text()
    result.write_page(tmp_path / "own.html")
    assert (tmp_path / "own.html").read_bytes() == (tmp_path / "page.html").read_bytes()
    assert result.says_no == (exit_code == 1) and [bool(v) for v in result.verdicts][:2] == [True, True]
    assert all(step == "fitting the set-ups" and done <= total == 3 for step, done, total in steps)
    told = json.loads(result.json_text())
    assert result.chi_square == pytest.approx(told["chi_square"]) and result.readings == told["readings"] == 60
    assert result.coverage == pytest.approx(result["within"].value) and result.ratio == pytest.approx(result["ratio"].value)
    assert result.coverage == told["components_within"] / told["components"]


def test_arrays_of_a_verification_agree_with_each_other():
    result = second_tracker().verify(trunnion())
    assert result.setups == ["tracker"] and result.left_out.count == 0 and result.uncertainties_known
    assert numpy.array_equal(result.residuals_before_mm("tracker"), result.before_mm)
    assert numpy.array_equal(result.residuals_after_mm("tracker"), result.after_mm)
    assert result.after_mm.shape == (60,) and result.norms("tracker").shape == (60,)
    assert result.before_statistics_mm.mean == pytest.approx(result.before_mm.mean())
    assert result.reduction == pytest.approx(result.before_mm.mean() / result.after_mm.mean())
    assert result.ratio == pytest.approx(numpy.sqrt(result.chi_square / result.degrees_of_freedom))
    assert result.p_value > 1e-6 and result.warnings == []
    with pytest.raises(KeyError):
        result.norms("other")


def test_readings_in_memory_are_those_of_the_file():
    study = second_tracker()
    from_file, given = study.verify(trunnion()), study.verify(trunnion(), study.gather())
    assert given.json_text() == from_file.json_text()


def test_a_change_of_the_machine_is_seen():
    changed = trunnion()
    changed.values_mm_rad = changed.values_mm_rad + 20e-6
    result = second_tracker().verify(changed)
    assert result.says_no and result.p_value < 1e-6
    assert {verdict.name: verdict.met for verdict in result.verdicts}["consistency"] is False


def test_readings_where_errors_are_not_known_are_left_out():
    study = second_tracker()
    commands = study.gather()["tracker"].positions_mm_rad[:, study.machine.axis_names.index("X")]
    middle = float(numpy.median(commands))
    errors = abbe.Errors(study.machine)
    errors.add_motion("EXX", coefficients_um=[0, 0.1], range_mm=(middle, float(commands.max())))
    result = study.verify(errors)
    covered = commands >= middle
    assert result.left_out.count == result.left_out.not_covered == (~covered).sum() > 0 and not result.uncertainties_known
    assert numpy.array_equal(numpy.isfinite(result.residuals_after_mm("tracker")), covered)
    assert numpy.array_equal(numpy.isfinite(result.norms("tracker")), covered) and len(result.after_mm) == covered.sum()
    errors = abbe.Errors(study.machine)
    errors.add_motion("EXX", coefficients_um=[0, 0.1], range_mm=(float(commands.max()) + 1, float(commands.max()) + 2))
    with pytest.raises(abbe.InputError, match="no reading is where all errors are known"):
        study.verify(errors)


def test_conditions_on_what_is_not_known_say_so():
    study = second_tracker()
    one = study.gather()["tracker"]
    three = abbe.Readings(one.instrument, one.positions_mm_rad[:3], one.measured_mm_rad[:3])
    result = study.verify(trunnion(), {"tracker": three}, largest_ratio=2)
    [ratio] = [verdict for verdict in result.verdicts if verdict.name == "ratio"]
    assert not ratio.met and ratio.text.startswith("NOT known, because there are no more readings")
    assert result.degrees_of_freedom == 0 and result.ratio == 0 and result.coverage is None
    levels = abbe.Study.read(EXAMPLES / "three_axis/level-and-autocollimator.study.toml")
    result = levels.verify(abbe.Errors(levels.machine), least_reduction=2)
    [reduction] = [verdict for verdict in result.verdicts if verdict.name == "reduction"]
    assert not reduction.met and reduction.text == "NOT known, because only angles are read" and len(result.after_mm) == 0


@bad_input
def test_mistakes_in_a_verification_are_named(names_argument):
    study, errors = second_tracker(), trunnion()
    for value in (0, -1, float("nan"), float("inf")):
        names_argument("least_reduction", lambda value=value: study.verify(errors, least_reduction=value))
        names_argument("largest_ratio", lambda value=value: study.verify(errors, largest_ratio=value))
    names_argument("errors", lambda: study.verify(abbe.Errors(machine("three-axis-mill"))))
    one = study.gather()["tracker"]
    few = abbe.Readings(one.instrument, one.positions_mm_rad[:1], one.measured_mm_rad[:1])
    none = abbe.Readings(one.instrument, one.positions_mm_rad[:0], one.measured_mm_rad[:0])
    for readings in (few, none):
        with pytest.raises(abbe.InputError):
            study.verify(errors, {"tracker": readings})
    with pytest.raises(KeyError):
        study.verify(errors, {"other": one})
    with pytest.raises(abbe.InputError, match="truth"):
        study.verify(errors, truth=errors)
    for wrong in (None, "errors.toml", 3):
        with pytest.raises(TypeError):
            study.verify(wrong)


def test_distrusted_errors_are_told():
    text = trunnion().text().replace("[[", 'distrusted = ["it does not fit"]\n\n[[', 1)
    marked = abbe.Errors.parse(text, machine("trunnion-mill"))
    with pytest.warns(UserWarning, match="march.toml: marked as not to be trusted: it does not fit"):
        second_tracker().verify(marked, errors_file="march.toml")


def test_a_verification_stops():
    def stop(*_):
        raise StopIteration

    study, finished = second_tracker(), []
    with pytest.raises(abbe.Stopped):
        long_verification(study, progress=stop)
    with pytest.raises(KeyboardInterrupt):
        threading.Timer(0.1, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
        finished.append(long_verification(study))
        threading.Event().wait(60)
    assert not finished


def long_verification(study, **more):
    """A verification that takes a while: the readings of the example many times."""
    one = study.gather()["tracker"]
    many = abbe.Readings(one.instrument, numpy.tile(one.positions_mm_rad, (400, 1)), numpy.tile(one.measured_mm_rad, (400, 1)))
    return study.verify(trunnion(), {"tracker": many}, **more)


# Checks against the nominal machine.

def clockwise_from_the_zenith(commands, measured):
    measured[:, 1] *= -1
    measured[:, 2] = numpy.pi / 2 - measured[:, 2]
    return commands, measured


def swapped_axes(commands):
    names = machine("trunnion-mill").axis_names
    x, y = names.index("X"), names.index("Y")
    commands[:, [x, y]] = commands[:, [y, x]]
    return commands


#: Of each mistake, and words of its diagnosis.
MISTAKES = {
    "clockwise and zenith": (clockwise_from_the_zenith, "the azimuth counts clockwise, and the elevation counts from the zenith"),
    "inch": (lambda c, m: (c, m * [1 / 25.4, 1, 1]), "inch"),
    "degrees": (lambda c, m: (c, numpy.column_stack([m[:, 0], numpy.degrees(m[:, 1:])])), "degrees"),
    "axes": (lambda c, m: (swapped_axes(c), m), "are swapped"),
}


@pytest.mark.parametrize("name", MISTAKES)
def test_a_mistake_is_named(name):
    change, words = MISTAKES[name]
    study = with_known_offset()
    check = study.check(spoiled(study, change))
    assert not check.explained and "not explained" in repr(check)
    [place] = check.unexplained
    assert place.place == "front" and place.readings == 60 and place.share < 0.8
    assert len(place.causes) == 1 and words in place.causes[0] and place.mended_rms_mm > 0
    assert place.text() in check.warnings[-1] and place.text() in check.text()
    assert check.setups[0].unexplained[0].causes == place.causes and check.to_dict()["explained"] is False


def test_a_station_that_moved_is_named():
    mill = abbe.Machine.from_chain("w X' Y' b Z t")
    study = abbe.Study(mill, {"setup": [{
        "name": "room", "instrument": "tracker", "noise": {"xyz_um": 5}, "station": [{"name": "left", "pose": "find"}],
        "reflector": [{"name": "spindle", "offset_mm": [0, 0, 0]}]}]})
    commands = numpy.random.default_rng(2).uniform(-200, 200, (80, 3))
    points = abbe.nominal_poses(mill, commands).points_mm
    room = study.instruments["room"]
    assert study.check({"room": abbe.Readings(room, commands, points)}).explained
    points[50:] = points[50:] @ abbe.rotation_xyz([0.1, 0.2, -0.05]).T + [120, -40, 30]
    [place] = study.check({"room": abbe.Readings(room, commands, points)}).unexplained
    assert place.place == "left" and place.causes == ["left moved after reading 49"] and place.mended_rms_mm < 1e-3


def test_a_check_is_that_of_the_command(tmp_path):
    study = second_tracker()
    good = study.check()
    assert good.explained and good.unexplained == [] and good.warnings == []
    assert good.text() == command(["check", TRACKER], tmp_path)
    assert good.json_text() == command(["check", TRACKER, "--json"], tmp_path)
    assert [(setup.name, setup.instrument, setup.readings) for setup in good.setups] == [("tracker", "tracker", 60)]
    document = study.to_dict()
    document |= {"machine": "mill.machine.toml"}
    document["setup"][0]["data"] = [{"file": "spoiled.csv"}]
    spoiled(study, clockwise_from_the_zenith)["tracker"].write(tmp_path / "spoiled.csv")
    path = abbe.Study(study.machine, document, folder=tmp_path, name="spoiled").write(tmp_path)
    bad = abbe.Study.read(path).check()
    assert not bad.explained and bad.text() == command(["check", path], tmp_path, 1)
    assert bad.json_text() == command(["check", path, "--json"], tmp_path, 1)


def test_nothing_explains_noise():
    study = with_known_offset()
    random = numpy.random.default_rng(1)
    check = study.check(spoiled(study, lambda c, m: (c, numpy.column_stack([
        random.uniform(500, 2000, len(m)), random.uniform(-3, 3, len(m)), random.uniform(-1, 1, len(m))]))))
    assert not check.explained and check.unexplained[0].causes == [] and check.unexplained[0].mended_rms_mm is None


def test_few_readings_and_simulated_ones_are_no_mistake():
    study = second_tracker()
    assert study.check(spoiled(study, lambda c, m: (c[:3], m[:3] * [2, 1, 1]))).explained
    [place] = study.check(spoiled(study, lambda c, m: (c[:5], m[:5] * [2, 1, 1]))).unexplained
    assert place.causes == [] and "too few to try the usual mistakes" in place.text()
    seen = []
    simulated = abbe.Study.read(EXAMPLES / "aguado/aguado.study.toml").check(progress=lambda *step: seen.append(step))
    assert simulated.explained and simulated.to_dict()["simulated"] is True and seen


@bad_input
def test_mistakes_in_a_check_are_named():
    study = second_tracker()
    with pytest.raises(KeyError):
        study.check({"other": study.gather()["tracker"]})
    with pytest.raises(abbe.InputError, match="truth"):
        study.check(truth=trunnion())
    with pytest.raises(TypeError):
        study.check({"tracker": 3})
    one = study.gather()["tracker"]
    with pytest.raises(abbe.InputError, match="nothing is measured"):
        study.check({"tracker": abbe.Readings(one.instrument, one.positions_mm_rad)})
    for length in (-5, 0):
        measured = one.measured_mm_rad.copy()
        measured[3, 0] = length
        with pytest.raises(abbe.InputError, match=f"measured: reading 3: the range is {length} mm"):
            abbe.Readings(one.instrument, one.positions_mm_rad, measured)


@bad_input
def test_readings_of_another_instrument_are_refused():
    study = second_tracker()
    one = study.gather()["tracker"]
    document = study.to_dict()
    del document["setup"][0]["measure"]  # coordinates, while the file has ranges and angles
    cartesian = abbe.Study(study.machine, document, folder=TRACKER.parent)
    assert cartesian.check().explained
    with pytest.raises(abbe.InputError, match="range, azimuth, elevation.*expected.*x, y, z"):
        cartesian.check(cartesian.gather())
    document = study.to_dict()
    document["setup"][0]["reflector"][0]["name"] = "another"
    with pytest.raises(abbe.InputError, match="are of another instrument.*on another"):
        abbe.Study(study.machine, document, folder=TRACKER.parent).verify(trunnion(), {"tracker": one})
    bar = {"name": "bar", "instrument": "ball-bar", "spindle_ball_mm": [0, 0, -100], "noise": {"length_um": 1},
           "ball": [{"name": "table", "centre_mm": [0, 0, 0]}]}
    mill, other = (abbe.Study(abbe.Machine.from_chain(chain), {"setup": [bar]}) for chain in ("w X' Y' b Z t", "w Y' X' b Z t"))
    readings = abbe.Readings(other.instruments["bar"], numpy.eye(3) * 100, numpy.full(3, 100.0))
    assert other.check({"bar": readings}).explained
    with pytest.raises(abbe.InputError, match="on a machine w Y' X' b Z t"):
        mill.check({"bar": readings})


def test_a_check_stops():
    def fail(*_):
        raise RuntimeError("of the user")

    with pytest.raises(RuntimeError, match="of the user"):
        abbe.Study.read(EXAMPLES / "aguado/aguado.study.toml").check(progress=fail)
