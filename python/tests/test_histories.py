"""The campaigns of a machine over the years: the same bytes as the command, and trends against their definitions."""

import datetime
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

MILL = EXAMPLES / "machines/three-axis-mill.machine.toml"
FILES = [EXAMPLES / f"compare/{month}.errors.toml" for month in ("march", "june", "october")]
DATES = ["2026-03-02", "2026-06-01", "2026-10-05"]
DAYS = [datetime.date.fromisoformat(date) for date in DATES]


def squareness(value_urad, u_urad=1.0, chain="w X' Y' b Z t"):
    errors = abbe.Errors(abbe.Machine.from_chain(chain))
    errors.add_location("EC0Y", value_urad=value_urad, u_urad=u_urad)
    return errors


def history_of(folder, values_urad, dates, **more):
    history = abbe.History(folder / "mill.history")
    assert history.add([squareness(value, **more) for value in values_urad], dates) == list(range(1, len(dates) + 1))
    return history


@pytest.fixture
def examples_history(tmp_path):
    history = abbe.History(tmp_path / "mill.history")
    assert history.add(FILES, DATES, machine=MILL) == [1, 2, 3]
    return history


STATES = """name = "mill"
chain = "w X' Y' b Z t"
[axis.X]
travel_mm = [0, 500]
[axis.Y]
travel_mm = [0, 400]
[axis.Z]
travel_mm = [-300, 0]
[state.ambient]
kind = "measured"
unit = "degC"
"""
ERRORS = """[[location]]
name = "EC0Y"
value_urad = {}
standard_uncertainty_urad = 1
[[location]]
name = "EC0Y"
state = "ambient"
value_urad = 2
standard_uncertainty_urad = 0.1
[covered]
ambient_degC = [{}, {}]
"""


def test_errors_with_states_are_followed_at_a_state(tmp_path):
    (tmp_path / "mill.machine.toml").write_text(STATES)
    # 4 urad a quarter of a year; the last one in summer.
    for k, covered in enumerate([(18, 22), (19, 23), (24, 28)]):
        (tmp_path / f"c{k}.errors.toml").write_text(ERRORS.format(10 + 4 * k, *covered))
    history = abbe.History(tmp_path / "mill.history")
    files = [tmp_path / f"c{k}.errors.toml" for k in range(3)]
    history.add(files, ["2026-01-01", "2026-04-02", "2026-07-02"], machine=tmp_path / "mill.machine.toml")
    trends = history.trends(states={"ambient_degC": 25.0})
    asked = ["history", "trends", history.path, "--state", "ambient_degC=25"]
    assert trends.json_text() == command([*asked, "--json"], tmp_path, 1)
    assert trends.at_state == {"ambient_degC": 25.0}
    assert len(trends.outside) == 2 and "c0: ambient_degC = 25 lies outside the 18 to 22" in trends.outside[0]
    error = trends.errors["EC0Y"]
    assert error.extrapolated == [True, True, False] and error.per == ""
    # 5 K from the reference: u^2 = 1 + (5 * 0.1)^2.
    numpy.testing.assert_allclose(error.standard_uncertainties_mm_rad, 1.25 ** 0.5 * 1e-6)
    numpy.testing.assert_allclose(error.changes_mm_rad, [0, 4e-6, 8e-6], atol=1e-12)
    assert trends.errors["EC0Y*ambient"].per == "K"
    assert history.trends().at_state == {"ambient_degC": 20.0}


@pytest.mark.parametrize("options, arguments", [
    ([], {}), (["--limit-um", 20], {"limit_um": 20}), (["--last", 2], {"last": 2}),
])
def test_trends_are_those_of_the_command(options, arguments, examples_history, tmp_path):
    steps = []
    trends = examples_history.trends(**arguments, progress=lambda *step: steps.append(step))
    asked = ["history", "trends", examples_history.path, *options]
    exit_code = 0 if trends.in_control else 1
    assert trends.text() == command(asked, tmp_path, exit_code)
    assert trends.json_text() == command([*asked, "--json"], tmp_path, exit_code)
    command([*asked, "-o", "wanted"], tmp_path, exit_code)
    trends.write(tmp_path / "own")
    wanted = {path.name: path.read_bytes() for path in (tmp_path / "wanted").iterdir()}
    assert wanted == {path.name: path.read_bytes() for path in (tmp_path / "own").iterdir()}
    assert trends.page_html().encode() == wanted["report.html"] and "trend-EXX" in trends.plot_names
    assert all(step == "comparing campaigns" and done <= total for step, done, total in steps)
    without_page = examples_history.trends(**arguments, page=False)
    assert without_page.json_text() == trends.json_text() and without_page.plot_names == []


def test_a_history_is_that_of_the_command(examples_history, tmp_path):
    dates = [part for date in DATES for part in ("--date", date)]
    command(["history", "add", "other.history", *FILES, *dates, "--machine", MILL], tmp_path)
    for other, own in zip(abbe.History(tmp_path / "other.history").campaigns(), examples_history.campaigns(), strict=True):
        assert (other.number, other.name, other.date, other.source) == (own.number, own.name, own.date, own.source)
        assert other.errors.text() == own.errors.text() and other.machine == own.machine
        assert numpy.array_equal(other.errors.covariance, own.errors.covariance)
    command(["history", "export", examples_history.path, "--campaign", 2, "-o", "wanted"], tmp_path)
    second = examples_history.campaigns()[1]
    second.write(tmp_path / "own")
    for path in (tmp_path / "wanted").iterdir():
        assert path.read_bytes() == (tmp_path / "own" / path.name).read_bytes()
    assert set(second.files()) == {"machine.toml", "errors.toml", "errors.covariance.csv"} and second.summary is None
    with pytest.raises(FileExistsError):
        second.write(tmp_path / "own")
    assert json.loads(command(["history", "list", examples_history.path, "--json"], tmp_path))[2]["day"] == DATES[2]


def test_values_are_those_of_the_json(examples_history):
    trends = examples_history.trends(limit_um=20)
    told = trends.to_dict()
    assert trends.names == ["march", "june", "october"] and trends.dates.dtype == "datetime64[D]"
    assert trends.dates.tolist() == DAYS and trends.names == [campaign["name"] for campaign in told["campaigns"]]
    assert trends.next_date == datetime.date.fromisoformat(told["measure_again_by"])
    assert trends.next_date == min(error.due for error in trends.errors.values() if error.due)
    assert trends.errors[trends.next_error].due == trends.next_date
    assert list(trends.errors) == [error["name"] for error in told["errors"]]
    for error, of in zip(trends.errors.values(), told["errors"], strict=True):
        unit, factor = ("urad", 1e6) if error.is_angle else ("um", 1e3)
        assert error.not_followed is None and error.words == of["words"] and len(error) == len(of["days"]) == 3
        assert (error.dates - error.dates[0]).astype(int).tolist() == of["days"] and error.campaigns.tolist() == [0, 1, 2]
        assert numpy.allclose(factor * error.changes_mm_rad, of["change_" + unit], atol=1e-6)
        assert numpy.allclose(factor * error.standard_uncertainties_mm_rad, of["standard_uncertainty_" + unit], atol=1e-6)
        for own, name in ((error.drift_mm_rad_per_year, f"drift_{unit}_per_year"), (error.scatter_mm_rad, "scatter_" + unit),
                          (error.drift_expanded_uncertainty_mm_rad_per_year, f"drift_expanded_uncertainty_{unit}_per_year"),
                          (error.expected_mm_rad, "expected_" + unit),
                          (error.expected_expanded_uncertainty_mm_rad, "expected_expanded_uncertainty_" + unit)):
            assert factor * own == pytest.approx(of[name], abs=1e-6)
        assert (error.drifts, error.last_is_expected) == (of["drifts"], of["last_is_expected"])
        assert error.coverage_factor == pytest.approx(of["coverage_factor"])
        assert (error.due.isoformat() if error.due else None) == of["limit_reached"]
        low, high = error.limits_mm_rad
        assert error.last_is_expected == (low <= error.changes_mm_rad[-1] <= high)
        assert (error.at_mm_rad is None) == ("at_mm" not in of)
    assert not trends.in_control and "not in control" in repr(trends) and trends["unexpected"].value >= 1


def test_a_line_is_found_and_predicted(tmp_path):
    dates = numpy.array(["2022-01-01", "2023-01-01", "2024-01-01", "2025-01-01"], dtype="datetime64[D]")
    days = (dates - dates[0]).astype(float)
    trends = history_of(tmp_path, 10 + 4 * days / 365.2425, dates).trends(limit_um=5)
    error = trends.errors["EC0Y"]
    assert error.is_angle and error.at_mm_rad is None and error.drifts and error.last_is_expected and trends.in_control
    assert 1e6 * error.drift_mm_rad_per_year == pytest.approx(4) and error.scatter_mm_rad == 0 and error.coverage_factor == 2
    assert numpy.allclose(1e6 * error.changes_mm_rad, 4 * days / 365.2425)
    # Weighted least squares with equal weights of 1 urad.
    u_slope = 365.2425 / numpy.sqrt(((days - days.mean()) ** 2).sum())
    assert 1e6 * error.drift_expanded_uncertainty_mm_rad_per_year == pytest.approx(2 * u_slope)
    later = [datetime.date(2025, 1, 1), numpy.datetime64("2026-01-01T12:00"), "2027-01-01"]
    values, expanded = error.predict(later)
    after = numpy.array([0, 365, 730.0])
    assert numpy.allclose(1e6 * values, 4 * (days[-1] + after) / 365.2425)
    u = numpy.sqrt(0.25 + (days[-1] + after - days.mean()) ** 2 / ((days - days.mean()) ** 2).sum())
    assert numpy.allclose(1e6 * expanded, 2 * u)
    assert [array.shape for array in error.predict([])] == [(0,), (0,)]
    assert numpy.allclose(error.predict(error.dates)[0], error.changes_mm_rad)
    # The day when the drift and the uncertainties reach the limit.
    due = (numpy.datetime64(error.due) - dates[-1]).astype(float) / 365.2425
    assert 4e-6 * due * error.tool_mm_per_mm_rad < 5e-3 and dates[-1] <= numpy.datetime64(error.due)


def test_campaigns_in_memory_and_in_folders(tmp_path):
    mill = abbe.Machine.from_chain("w X' Y' b Z t")
    study = abbe.Study(mill, {
        "simulate": {"generator": {"seed": 1, "mean_volumetric_um": 20}},
        "setup": [{"name": "bar", "instrument": "ball-bar", "spindle_ball_mm": [0, 0, -100],
                   "ball": [{"name": "table", "centre_mm": [0, 0, 0]}], "noise": {"length_um": 0.5},
                   "plan": [{"kind": "circle", "plane": ["X", "Y"], "radius_mm": 100, "points": 60}]}],
        "identify": {"locations": ["EC0Y"]}}, name="bar")
    result = study.run(truth=squareness(20))
    result.write(tmp_path / "results")
    memory, folder = abbe.History(tmp_path / "memory.history"), abbe.History(tmp_path / "folder.history")
    memory.add([result], [DAYS[0]])
    memory.add([squareness(21)], numpy.array([DATES[1]], dtype="datetime64[ns]"))
    folder.add([tmp_path / "results"], DATES[:1])
    folder.add([squareness(21)], [datetime.datetime(2026, 6, 1, 23, 59)], names=["June"])
    first, second = memory.campaigns()
    assert (first.name, first.source, second.name, second.source) == ("bar", "memory", "2026-06-01", "memory")
    assert first.summary == result.to_dict()
    of_folder, june = folder.campaigns()
    assert of_folder.summary == first.summary and june.name == "June"
    assert numpy.array_equal(of_folder.errors.values_mm_rad, first.errors.values_mm_rad)
    assert numpy.allclose(of_folder.errors.covariance, first.errors.covariance, rtol=1e-12, atol=0)
    assert (of_folder.source, june.date) == (str(tmp_path / "results"), DAYS[1])
    assert first.abbe_version == abbe.__version__ and first.added.endswith("Z") and first.machine.chain == mill.chain
    names = {"memory": memory, "folder": folder}
    changes = {name: history.trends().errors["EC0Y"].changes_mm_rad.tolist() for name, history in names.items()}
    assert changes["memory"] == changes["folder"]


def test_two_campaigns_have_no_scatter(tmp_path):
    error = history_of(tmp_path, [20, 40], DAYS[:2]).trends().errors["EC0Y"]
    assert error.scatter_mm_rad is None and error.due is None and not error.last_is_expected
    assert error.expected_mm_rad == 0 and error.probability < 1e-6


def test_errors_without_uncertainty_are_not_followed(tmp_path):
    history = abbe.History(tmp_path / "mill.history")
    errors = [abbe.Errors(abbe.Machine.from_chain("w X' Y' b Z t")) for _ in range(2)]
    for one, value in zip(errors, (1, 2)):
        one.add_location("EC0Y", value_urad=value)
    history.add(errors, DAYS[:2])
    trends = history.trends(limit_um=1)
    error = trends.errors["EC0Y"]
    assert error.not_followed and error.drift_mm_rad_per_year is error.expected_mm_rad is error.limits_mm_rad is None
    assert error.last_is_expected is error.coverage_factor is error.due is trends.next_date is None and len(error) == 0
    assert error.changes_mm_rad.shape == error.dates.shape == error.campaigns.shape == (0,) and "not followed" in repr(error)
    assert trends.next_error == "" and trends.in_control and len(trends.errors_to_dataframe()) == 0
    with pytest.raises(abbe.InputError, match="EC0Y has no trend"):
        error.predict(DATES)


def test_tables_are_frames(examples_history):
    trends = examples_history.trends(limit_um=20)
    frame = trends.errors_to_dataframe()
    assert frame.loc["EC0Y", "unit"] == "urad" and frame.loc["EXX", "unit"] == "um" and frame["scatter"].dtype == float
    assert frame.loc["EXX", "change"] == pytest.approx(1e3 * trends.errors["EXX"].changes_mm_rad[-1])
    assert frame.loc[trends.next_error, "due"] == trends.next_date
    assert trends.to_dataframe().loc["followed", "value"] == len(frame)


@bad_input
def test_bad_days_are_named(tmp_path):
    history = abbe.History(tmp_path / "mill.history")
    for bad in ("2026-02-30", "March", "", "2026-3-2", "\ud800", numpy.datetime64("NaT"), numpy.datetime64("2026-03"),
                numpy.datetime64("2026"), numpy.float64(3), numpy.array([1, 2])):
        with pytest.raises(abbe.InputError, match="dates"):
            history.add([squareness(1)], [bad])
    for bad in (3, None, b"2026-03-02", 3.5, object()):
        with pytest.raises(TypeError):
            history.add([squareness(1)], [bad])
    with pytest.raises(TypeError):
        history.add([squareness(1)], "2026-03-02")
    pandas = pytest.importorskip("pandas")
    with pytest.raises(abbe.InputError, match="dates"):
        history.add([squareness(1)], [pandas.NaT])
    assert not (tmp_path / "mill.history").exists()
    history.add([squareness(1), squareness(2)], pandas.Series(pandas.to_datetime(DATES[:2])))
    assert [one.date for one in history.campaigns()] == DAYS[:2]


@bad_input
@pytest.mark.parametrize("name, call", {
    "campaigns": lambda h: h.add([], []),
    "dates": lambda h: h.add([squareness(5)], DATES),
    "machine": lambda h: h.add([squareness(5)], DATES[:1], machine=MILL),
    "names": lambda h: h.add([squareness(5)], DATES[:1], names=[]),
    "limit_um": lambda h: h.trends(limit_um=-1),
    "limit_um: is nan": lambda h: h.trends(limit_um=float("nan")),
    "limit_um: is 0": lambda h: h.trends(limit_um=0),
    "last": lambda h: h.trends(last=1),
    "is the database of another program": lambda h: abbe.History("other.db").campaigns(),
    "missing.history": lambda h: abbe.History("missing.history").campaigns(),
    "no.errors.toml": lambda h: h.add(["no.errors.toml"], DATES[:1], machine=MILL),
    "in the history already": lambda h: h.add([squareness(1)], DATES[2:]),
    "its machine is": lambda h: h.add([squareness(1, chain="w X' b Y Z t")], DATES[2:]),
    "too large for an error of a machine": lambda h: h.add([squareness(1e12)], DATES[2:]),
    "no two days": lambda h: history_of_one_day().trends(),
}.items())
def test_mistakes_are_named(name, call, names_argument, tmp_path):
    history_of(tmp_path, [1, 2], DATES[:2])
    import sqlite3
    with sqlite3.connect(tmp_path / "other.db") as other:
        other.execute("CREATE TABLE it (number INTEGER)")
    other.close()
    names_argument(name, lambda: call(abbe.History(tmp_path / "mill.history")))
    assert len(abbe.History(tmp_path / "mill.history").campaigns()) == 2


def history_of_one_day():
    history = abbe.History("day.history")
    history.add([squareness(1), squareness(2)], [DAYS[0]] * 2)
    return history


@bad_input
def test_a_damaged_file_is_refused(tmp_path):
    history = history_of(tmp_path, [1, 2], DATES[:2])
    whole = history.path.read_bytes()
    for damaged in (b"", b"no database", whole[:1000], whole[:100] + b"\xff" * (len(whole) - 100)):
        history.path.write_bytes(damaged)
        with pytest.raises(abbe.InputError):
            history.campaigns()


def test_distrusted_errors_are_told(tmp_path):
    text = FILES[0].read_text().replace('covariance = "march.covariance.csv"', 'distrusted = ["it does not fit"]')
    errors = abbe.Errors.parse(text, machine("three-axis-mill"))
    with pytest.warns(UserWarning, match="March: marked as not to be trusted: it does not fit"):
        abbe.History(tmp_path / "mill.history").add([errors], DATES[:1], names=["March"])


def many_campaigns(tmp_path):
    errors, history, campaigns = trunnion(), abbe.History(tmp_path / "many.history"), []
    for number in range(26):
        one = errors.copy()
        one.values_mm_rad = errors.values_mm_rad + number * 1e-7
        campaigns.append(one)
    history.add(campaigns, numpy.datetime64("2024-01-01") + 30 * numpy.arange(26))
    return history


def test_progress_stops_and_an_interruption_ends_trends(tmp_path):
    def stop(*_):
        raise StopIteration

    def fail(*_):
        raise RuntimeError("of the user")

    history, finished = many_campaigns(tmp_path), []
    with pytest.raises(abbe.Stopped):
        history.trends(progress=stop)
    with pytest.raises(RuntimeError, match="of the user"):
        history.trends(progress=fail)
    with pytest.raises(KeyboardInterrupt):
        threading.Timer(0.2, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
        finished.append(history.trends())
        threading.Event().wait(60)
    assert not finished


def test_threads_add_at_the_same_time(tmp_path):
    history, numbers = abbe.History(tmp_path / "mill.history"), []
    threads = [threading.Thread(target=lambda k=k: numbers.extend(history.add([squareness(k)], [DAYS[0]]))) for k in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert sorted(numbers) == list(range(1, 9)) and len(history.campaigns()) == 8
