"""Studies: from files and in code, with readings from arrays; the same bytes as the command."""

import os
import signal
import threading

import numpy
import pytest

import abbe

BAR = {
    "name": "bar", "instrument": "ball-bar", "spindle_ball_mm": [0, 0, -100],
    "ball": [{"name": "table", "centre_mm": [0, 0, 0]}], "noise": {"length_um": 0.1},
    "plan": [{"kind": "circle", "plane": [a, b], "radius_mm": 100, "points": 40} for a, b in ("XY", "YZ", "XZ")],
}
DOCUMENT = {"simulate": {"generator": {"seed": 3, "mean_volumetric_um": 20}}, "setup": [BAR],
            "identify": {"locations": ["EC0Y", "EA0Z", "EB0Z"]}}


@pytest.fixture
def mill():
    return abbe.Machine.from_chain("w X' Y' b Z t")


def squareness(machine):
    errors = abbe.Errors(machine)
    for name, value in (("EC0Y", 30), ("EA0Z", -20), ("EB0Z", 50)):
        errors.add_location(name, value_urad=value)
    return errors


def test_squareness_from_arrays(mill):
    truth = squareness(mill)
    study = abbe.Study(mill, DOCUMENT)
    readings = study.gather(truth=truth)
    plain = study.to_dict()
    del plain["simulate"]
    del plain["setup"][0]["plan"]
    measured = abbe.Study(mill, plain)
    bar = readings["bar"]
    again = abbe.Readings(measured.instruments["bar"], bar.positions_mm_rad, bar.measured_mm_rad)
    result = measured.run({"bar": again}, map=False)
    assert result.trusted and result.status == "converged"
    found = dict(zip(result.names, result.estimates_mm_rad))
    for name, value in (("EC0Y", 30e-6), ("EA0Z", -20e-6), ("EB0Z", 50e-6)):
        assert abs(found[name] - value) < 5 * result.standard_uncertainties_mm_rad[result.names.index(name)]
    numpy.testing.assert_array_equal(result.estimates_mm_rad, study.run(truth=truth, map=False).estimates_mm_rad)
    assert result.residuals_mm_rad("bar").shape == (120, 1) and result.used("bar").sum() > 100
    assert result.errors.covariance.shape == (len(result.errors),) * 2 and result.truth is None
    with pytest.raises(KeyError):
        result.readings("other")


def test_a_study_goes_to_a_file_and_back(mill, tmp_path):
    study = abbe.Study(mill, DOCUMENT, name="square")
    path = study.write(tmp_path)
    again = abbe.Study.read(path)
    assert again.machine == mill and again.to_dict() == study.to_dict()
    numpy.testing.assert_array_equal(again.run(map=False).estimates_mm_rad, study.run(map=False).estimates_mm_rad)
    with pytest.raises(FileExistsError):
        study.write(tmp_path)
    assert abbe.Study.parse(study.text(), mill).to_dict() == study.to_dict()


@pytest.mark.skipif("ABBE_COMMAND" not in os.environ, reason="needs the command")
@pytest.mark.parametrize("name", ["aguado/aguado", "trunnion/ball-bar", "rotary_table/polygon"])
def test_results_have_the_bytes_of_the_command(name, examples, tmp_path):
    import subprocess

    file = examples / f"{name}.study.toml"
    result = abbe.Study.read(file).run()
    result.write(tmp_path / "python")
    subprocess.run([os.environ["ABBE_COMMAND"], "run", file, "-o", tmp_path / "command", "--quiet"], check=False)
    ours = sorted(p.relative_to(tmp_path / "python") for p in (tmp_path / "python").rglob("*") if p.is_file())
    theirs = sorted(p.relative_to(tmp_path / "command") for p in (tmp_path / "command").rglob("*") if p.is_file())
    assert ours == theirs and len(ours) > 4
    for file in ours:
        assert (tmp_path / "python" / file).read_bytes() == (tmp_path / "command" / file).read_bytes(), file


def test_every_instrument_is_there():
    assert {"tracker", "ball-bar", "r-test", "interferometer", "grid-encoder"} <= set(abbe.INSTRUMENTS)


@pytest.mark.parametrize("change, field", [
    ({"setup": []}, "identify"), ({"identify": {"locations": ["EC0Q"]}}, "identify.locations"),
    ({"setup": [dict(BAR, noise={"length_kg": 1})]}, "setup[1].noise.length_kg"), ({"seed": -1}, "seed"),
    ({"setup": [dict(BAR, instrument="ruler")]}, "setup[1].instrument"), ({"surprise": 1}, "surprise"),
])
def test_mistakes_in_a_study_are_named(mill, change, field):
    with pytest.raises(abbe.InputError) as caught:
        abbe.Study(mill, {**DOCUMENT, **change})
    assert caught.value.field == field


def test_mistakes_in_readings_are_named(mill):
    document = {k: v for k, v in DOCUMENT.items() if k != "simulate"}
    document["setup"] = [{k: v for k, v in BAR.items() if k != "plan"}]
    study = abbe.Study(mill, document)
    bar = study.instruments["bar"]
    good = numpy.zeros((4, 3))
    with pytest.raises(abbe.InputError, match="no readings"):
        study.run()
    with pytest.raises(KeyError):
        study.run({"other": abbe.Readings(bar, good, numpy.ones(4))})
    with pytest.raises(abbe.InputError, match="a plan"):
        study.run({"bar": abbe.Readings(bar, good)})
    for call in (abbe.Readings(bar, good).csv, lambda: abbe.Readings(bar, good).write("plan.csv")):
        with pytest.raises(abbe.InputError, match="a plan"):
            call()
    for wrong in (numpy.ones(3), numpy.ones((4, 2)), "abcd", numpy.full(4, numpy.nan)):
        with pytest.raises(abbe.InputError):
            abbe.Readings(bar, good, wrong)
    with pytest.raises(abbe.InputError, match="outside the travel"):
        abbe.Readings(bar, good + 1e4, numpy.ones(4))
    with pytest.raises(KeyError):
        abbe.Readings(bar, good, numpy.ones(4), items="wall")
    for key, value in (("items", ["table"]), ("approach", numpy.full((4, 3), 2)), ("time_s", [1]),
                       ("standard_uncertainties_mm_rad", numpy.zeros(4)), ("inputs_mm_rad", numpy.ones((4, 2)))):
        with pytest.raises(abbe.InputError):
            abbe.Readings(bar, good, numpy.ones(4), **{key: value})
    assert len(abbe.Readings(bar, numpy.zeros((0, 3)), numpy.zeros(0))) == 0
    with pytest.raises(abbe.InputError):
        study.run({"bar": abbe.Readings(bar, numpy.zeros((0, 3)), numpy.zeros(0))})
    with pytest.raises(abbe.InputError):
        abbe.Study(mill, DOCUMENT).run({"bar": abbe.Readings(bar, good, numpy.ones(4))})


def test_too_few_readings_give_no_errors(mill):
    document = {k: v for k, v in DOCUMENT.items() if k != "simulate"}
    document["setup"] = [{k: v for k, v in BAR.items() if k != "plan"}]
    study = abbe.Study(mill, document)
    result = study.run({"bar": abbe.Readings(study.instruments["bar"], numpy.eye(3) * 100, numpy.ones(3))})
    assert not result.usable and not result.trusted and result.message
    with pytest.raises(abbe.InputError, match="there are none"):
        result.errors


def test_advice_can_be_left_out(mill):
    study = abbe.Study(mill, DOCUMENT)
    advised, plain = study.run(map=False), study.run(map=False, advice=False)
    assert plain.errors.text() == advised.errors.text()
    assert numpy.array_equal(plain.covariance, advised.covariance)
    assert plain.to_dict()["not_identified"]["errors"] == advised.to_dict()["not_identified"]["errors"]
    assert advised.to_dict()["not_identified"]["shown_by"] and not plain.to_dict()["not_identified"]["shown_by"]


def test_progress_and_stopping(mill, examples):
    study = abbe.Study.read(examples / "aguado/aguado.study.toml")
    seen = []
    study.run(progress=lambda *report: seen.append(report))
    assert seen and all(isinstance(step, str) and 0 <= done <= total for step, done, total in seen)

    def stop(*_):
        raise StopIteration

    def fail(*_):
        raise RuntimeError("of the user")

    with pytest.raises(abbe.Stopped):
        study.run(progress=stop)
    with pytest.raises(RuntimeError, match="of the user"):
        study.run(progress=fail)


def test_an_interruption_ends_a_plan(examples):
    threading.Timer(0.2, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
    with pytest.raises(KeyboardInterrupt):
        abbe.Study.read(examples / "trunnion/trunnion.study.toml").plan()
        threading.Event().wait(5)


def test_a_plan_can_be_simulated(examples):
    study = abbe.Study.read(examples / "trunnion/trunnion.study.toml")
    plan = study.plan()
    assert plan.done and len(plan) == len(plan.positions_mm_rad) == len(plan.setups)
    assert plan.curve[-1, 1] < plan.curve[0, 1] and plan.csv().count("\n") > len(plan)
    readings = plan.readings(plan.setups[0]).simulate(abbe.Errors.random(study.machine, mean_volumetric_um=20))
    assert 0 < len(readings) <= len(plan)


def test_tables_and_html(mill):
    pandas = pytest.importorskip("pandas")
    result = abbe.Study(mill, DOCUMENT).run(map=False)
    frame = result.to_dataframe()
    assert isinstance(frame, pandas.DataFrame) and frame.loc["EC0Y", "unit"] == "urad"
    assert frame.loc["EC0Y", "value"] == pytest.approx(1e6 * result.estimates_mm_rad[result.names.index("EC0Y")])
    assert list(result.readings("bar").to_dataframe().columns)[:3] == ["X_mm", "Y_mm", "Z_mm"]
    assert "EC0Y" in result._repr_html_() and "<table>" in result.errors._repr_html_()
    assert len(result.errors.to_dataframe()) == len(result.errors)


def test_plots(mill):
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    from abbe import plot

    result = abbe.Study(mill, {**DOCUMENT, "identify": {"motion": [{"errors": ["EXX", "EYX"], "basis": "legendre", "order": 1}]}}).run(map=False)
    figure = plot.residuals(result)
    assert len(figure.axes) == 2
    errors = abbe.Errors.random(mill)
    assert len(plot.error_motions(errors).axes) == 6
    q = abbe.grid(mill, X_mm=[0, 100], Y_mm=[0, 100])
    plot.error_map(abbe.nominal_poses(mill, q).points_mm, abbe.PoseModel(errors).deviations(q)[:, :3])
    plot.polar(numpy.arange(0, 360, 10), numpy.ones(36))
    plot.trend([1, 2], [3, 4], [0.1, 0.1], label="EC0Y", unit="urad", limits=(0, 5))
    for wrong in (lambda: plot.polar([1, 2], [1]), lambda: plot.error_map([[1, 2]], [[1, 2]]), lambda: plot.trend([1], [1, 2])):
        with pytest.raises(abbe.InputError):
            wrong()
    matplotlib.pyplot.close("all")
