"""Campaigns against each other: the same bytes as the command, and arrays against their definitions."""

import gc
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
ENDS = [FILES[0], FILES[2]]
NAMES = ["march", "june", "october"]

#: Of each: the campaigns, what the command is asked, and the same of Python.
CALLS = {
    "two campaigns": (ENDS, [], {}),
    "three campaigns": (FILES, ["--level-percent", 1], {"level_percent": 1}),
    "tolerances": (FILES, ["--tolerance", "V_max_C_A_um=20", "--tolerance", "changed_B_A=0.5"],
                   {"tolerances": {"V_max_C_A_um": 20, "changed_B_A": 0.5}}),
    "a tolerance is exceeded": (ENDS, ["--tolerance", "V_max_um=5"], {"tolerances": {"V_max_um": 5}}),
}


def errors_of(path):
    return abbe.Errors.read(path, machine("three-axis-mill"))


def squareness(value_urad, **more):
    errors = abbe.Errors(abbe.Machine.from_chain("w X' Y' b Z t"))
    errors.add_location("EC0Y", value_urad=value_urad, **more)
    return errors


@pytest.mark.parametrize("name", CALLS)
def test_results_are_those_of_the_command(name, tmp_path):
    campaigns, options, arguments = CALLS[name]
    asked = ["compare", *campaigns, "--machine", MILL, *options]
    exit_code = 1 if "exceeded" in name else 0
    steps = []
    result = abbe.compare(campaigns, machine=MILL, **arguments, progress=lambda *step: steps.append(step))
    assert result.ok == (exit_code == 0) and result.judged and result.exceeds_tolerance == (not result.ok)
    assert result.text() == command(asked, tmp_path, exit_code)
    assert result.json_text() == command([*asked, "--json"], tmp_path, exit_code)
    assert result.to_dict() == json.loads(result.json_text())
    command([*asked, "-o", "wanted"], tmp_path, exit_code)
    result.write(tmp_path / "own")
    wanted = {path.name: path.read_bytes() for path in (tmp_path / "wanted").iterdir()}
    assert wanted == {path.name: path.read_bytes() for path in (tmp_path / "own").iterdir()}
    assert result.files() == {name: text for name, text in wanted.items() if name != ".abbe-results"}
    assert {"report.html", "evaluation.json"} < set(wanted) and any(name.endswith(".vts") for name in wanted)
    assert result.page_html().encode() == wanted["report.html"]
    with pytest.raises(FileExistsError):
        result.write(tmp_path / "own")
    assert all(step == "comparing campaigns" and done <= total for step, done, total in steps)
    without_page = abbe.compare(campaigns, machine=machine("three-axis-mill"), **arguments, page=False)
    assert without_page.json_text() == result.json_text() and without_page.plot_names == []
    assert without_page.pairs[0]["EXX"].curve is None and result.pairs[0]["EXX"].curve is not None


def test_values_are_those_of_the_json():
    result = abbe.compare(FILES, machine=MILL)
    assert result.names == NAMES and result.level_percent == 5 and result.machine.chain == "w X' Y' b Z t"
    assert [(pair.first, pair.second) for pair in result.pairs] == [(0, 1), (0, 2), (1, 2)]
    for pair, told in zip(result.pairs, result.to_dict()["pairs"], strict=True):
        assert [error.name for error in pair.errors] == [error["name"] for error in told["errors"]]
        assert (pair.chi_square, pair.degrees_of_freedom, pair.probability) == (
            told["chi_square"], told["degrees_of_freedom"], told["probability"])
        assert pair.share == told["share_beyond_uncertainty"] and len(pair.change) == told["poses"]
        assert pair.poses_words == told["description"] and pair.only_first == told["only_in_first"] == []
        assert pair.partial.missing == told["not_in_both"] and not pair.tools_differ and pair.conventions == []
        for error, of in zip(pair.errors, told["errors"], strict=True):
            unit, factor = ("_urad", 1e6) if error.is_angle else ("_um", 1e3)
            numbers = (error.change_mm_rad, error.expanded_uncertainty_mm_rad, *error.values_mm_rad)
            assert numpy.allclose(numpy.multiply(factor, numbers), [
                of[key + unit] for key in ("change", "expanded_uncertainty", "first", "second")], atol=1e-6)
            assert (error.words, error.verdict, error.chi_square, error.degrees_of_freedom, error.probability,
                    error.adjusted_probability) == tuple(of[key] for key in (
                        "words", "verdict", "chi_square", "degrees_of_freedom", "probability", "adjusted_probability"))
            assert 1e3 * error.at_tool_mm == pytest.approx(of["largest_at_tool_um"], abs=1e-6)
            assert error.is_motion == ("at_mm" in of)
            if error.is_motion:
                assert error.at_mm_rad == pytest.approx(of["at_mm"])
                assert error.range_mm_rad == pytest.approx(tuple(of["range_mm"]))
                assert error.only_described_mm_rad == (0, 0)
            else:
                assert error.at_mm_rad is error.range_mm_rad is error.only_described_mm_rad is error.curve is None
    assert [pair.changed for pair in result.pairs] == [[], ["EXX", "EC0Y"], ["EXX", "EC0Y"]]
    assert result["changed_C_A"].value == 2 and "4 significant changes" in repr(result)
    with pytest.raises(KeyError):
        result.pairs[0]["EQX"]


def test_arrays_are_those_of_their_definitions():
    earlier, later = map(errors_of, ENDS)
    pair = abbe.compare([earlier, later]).pairs[0]
    for error in pair.errors:
        if not error.is_motion:
            continue
        curve, axis = error.curve, error.name[2]
        largest = numpy.abs(curve.change_mm_rad).argmax()
        assert numpy.allclose(curve.change_mm_rad, curve.second_mm_rad - curve.first_mm_rad, atol=1e-12)
        assert numpy.allclose(curve.u_change_mm_rad, numpy.hypot(curve.u_first_mm_rad, curve.u_second_mm_rad))
        assert error.change_mm_rad == pytest.approx(curve.change_mm_rad[largest])
        assert error.expanded_uncertainty_mm_rad == pytest.approx(2 * curve.u_change_mm_rad[largest])
        assert error.at_mm_rad == pytest.approx(curve.positions_mm_rad[largest])
        assert (curve.positions_mm_rad[0], curve.positions_mm_rad[-1]) == pytest.approx(error.range_mm_rad)
        component = "XYZABC".index(error.name[1])
        for errors, values in ((earlier, curve.first_mm_rad), (later, curve.second_mm_rad)):
            assert numpy.allclose(errors.evaluate(axis, curve.positions_mm_rad)[:, component], values, atol=1e-12)
    # Holm's procedure over the errors of the pair.
    p = numpy.array([error.probability for error in pair.errors])
    order = p.argsort()
    steps = numpy.maximum.accumulate((len(p) - numpy.arange(len(p))) * p[order]).clip(max=1)
    assert numpy.allclose(numpy.array([error.adjusted_probability for error in pair.errors])[order], steps, rtol=1e-12)
    assert pair.changed == [error.name for error in pair.errors if error.adjusted_probability <= 0.05]
    change, uncertainty = pair.change, pair.change.uncertainty_mm_rad
    assert numpy.allclose(pair.expanded_uncertainty_mm, 2 * numpy.linalg.norm(uncertainty[:, :3], axis=1))
    assert pair.share == pytest.approx((change.norm_mm > pair.expanded_uncertainty_mm).mean())
    assert pair.positions_mm_rad.shape == (len(change), 3) and numpy.prod(pair.grid) == len(change)


def test_campaigns_in_memory_are_those_of_their_files():
    files = abbe.compare(FILES, machine=MILL)
    memory = abbe.compare([errors_of(path) for path in FILES], names=NAMES)
    mixed = abbe.compare([FILES[0], errors_of(FILES[1]), str(FILES[2])], machine=MILL, names=NAMES)
    for other in (memory, mixed):
        assert other.to_dict()["pairs"] == files.to_dict()["pairs"] and other.names == files.names
        assert other.to_dict()["figures"] == files.to_dict()["figures"]
    assert memory.to_dict()["facts"]["A"] == "march" and str(FILES[0]) in files.to_dict()["facts"]["A"]
    assert abbe.compare([errors_of(path) for path in ENDS]).names == ["campaign 1", "campaign 2"]
    assert abbe.compare([FILES[0], FILES[0]], machine=MILL).names == [str(FILES[0]), f"{FILES[0]} (2)"]


def test_results_of_studies_and_their_folders(tmp_path):
    mill = abbe.Machine.from_chain("w X' Y' b Z t")

    def campaign(seed, value_urad):
        study = abbe.Study(mill, {
            "simulate": {"generator": {"seed": seed, "mean_volumetric_um": 20}},
            "setup": [{"name": "bar", "instrument": "ball-bar", "spindle_ball_mm": [0, 0, -100],
                       "ball": [{"name": "table", "centre_mm": [0, 0, 0]}], "noise": {"length_um": 0.5},
                       "plan": [{"kind": "circle", "plane": ["X", "Y"], "radius_mm": 100, "points": 60}]}],
            "identify": {"locations": ["EC0Y"]}}, name=f"seed {seed}")
        return study.run(truth=squareness(value_urad))

    results = [campaign(1, 20), campaign(2, 20), campaign(3, 60)]
    memory = abbe.compare(results)
    assert memory.names == ["seed 1", "seed 2", "seed 3"] and memory.judged
    assert [pair.changed for pair in memory.pairs] == [[], ["EC0Y"], ["EC0Y"]]
    error = memory.pairs[1]["EC0Y"]
    assert abs(error.change_mm_rad - 40e-6) < 2 * error.expanded_uncertainty_mm_rad
    for number, result in enumerate(results):
        result.write(tmp_path / f"seed {number + 1}")
    folders = [tmp_path / name for name in memory.names]
    assert abbe.compare(folders).to_dict()["pairs"] == memory.to_dict()["pairs"]
    assert abbe.compare(folders).text() == command(["compare", *folders], tmp_path)


@bad_input
def test_what_cannot_be_judged_says_so():
    nothing = abbe.compare([squareness(20), squareness(50)])
    error = nothing.pairs[0]["EC0Y"]
    assert not nothing.judged and not nothing.ok and not nothing.exceeds_tolerance and "not all judged" in repr(nothing)
    assert error.verdict == "not_known" and error.change_mm_rad == pytest.approx(30e-6)
    assert error.expanded_uncertainty_mm_rad is error.chi_square is error.probability is error.degrees_of_freedom is None
    pair = nothing.pairs[0]
    assert pair.expanded_uncertainty_mm is pair.share is pair.chi_square is pair.probability is None
    assert pair.change.uncertainty_mm_rad is None and pair.changed == []
    other = abbe.Errors(abbe.Machine.from_chain("w X' Y' b Z t"))
    other.add_location("EA0Z", value_urad=5, u_urad=1)
    apart = abbe.compare([squareness(20, u_urad=1), other])
    pair = apart.pairs[0]
    assert not apart.judged and pair.errors == [] and (pair.only_first, pair.only_second) == (["EC0Y"], ["EA0Z"])
    assert pair.change is pair.positions_mm_rad is None and pair.grid == [] and apart["V_max"].value is None
    assert len(pair.to_dataframe()) == 0 and apart.text() and apart.page_html()
    empty = abbe.Errors(abbe.Machine.from_chain("w X' Y' b Z t"))
    assert not abbe.compare([empty, empty]).judged


def test_no_change_is_none():
    march = errors_of(FILES[0])
    same = abbe.compare([march, march])
    assert same.ok and same["changed"].value == 0 and same["V_max"].value < 1e-9 and same.pairs[0].share == 0
    assert all(error.change_mm_rad == 0 and error.adjusted_probability == 1 for error in same.pairs[0].errors)


def test_parts_outlive_the_comparison():
    kept = abbe.compare(ENDS, machine=MILL)
    curve, change = abbe.compare(ENDS, machine=MILL).pairs[0]["EXX"].curve, abbe.compare(ENDS, machine=MILL).pairs[0].change
    gc.collect()
    norm = change.norm_mm
    del change
    others = [abbe.compare(ENDS, machine=MILL) for _ in range(3)]
    assert numpy.array_equal(curve.change_mm_rad, kept.pairs[0]["EXX"].curve.change_mm_rad)
    assert numpy.array_equal(norm, kept.pairs[0].change.norm_mm) and len(others) == 3


def test_tables_are_frames():
    pair = abbe.compare(ENDS, machine=MILL).pairs[0]
    frame = pair.to_dataframe()
    assert frame.loc["EC0Y", "unit"] == "urad" and frame.loc["EXX", "verdict"] == "changed"
    assert frame.loc["EXX", "change"] == pytest.approx(1e3 * pair["EXX"].change_mm_rad)
    assert list(frame.index) == [error.name for error in pair.errors] and frame["U"].dtype == float
    assert abbe.compare([squareness(1), squareness(2)]).pairs[0].to_dataframe()["p"].isna().all()
    assert "V_max" in abbe.compare(ENDS, machine=MILL).to_dataframe().index


@bad_input
@pytest.mark.parametrize("name, call", [
    ("campaigns", lambda: abbe.compare([])), ("campaigns", lambda: abbe.compare([squareness(1)])),
    ("campaigns", lambda: abbe.compare([squareness(1)] * 27)),
    ("level_percent", lambda: abbe.compare([squareness(1)] * 2, level_percent=0)),
    ("level_percent", lambda: abbe.compare([squareness(1)] * 2, level_percent=51)),
    ("level_percent", lambda: abbe.compare([squareness(1)] * 2, level_percent=numpy.nan)),
    ("V_most_um", lambda: abbe.compare([squareness(1)] * 2, tolerances={"V_most_um": 1})),
    ("tolerance", lambda: abbe.compare([squareness(1)] * 2, tolerances={"V_max_um": numpy.nan})),
    ("machine", lambda: abbe.compare(ENDS)), ("machine", lambda: abbe.compare([squareness(1)] * 2, machine=MILL)),
    ("nowhere", lambda: abbe.compare(["nowhere.errors.toml", FILES[0]], machine=MILL)),
    ("nowhere", lambda: abbe.compare(ENDS, machine="nowhere.machine.toml")),
    ("names", lambda: abbe.compare([squareness(1)] * 2, names=["one"])),
    ("names", lambda: abbe.compare([squareness(1)] * 2, names=["one", "one"])),
    ("names", lambda: abbe.compare([squareness(1)] * 2, names=["one", ""])),
    ("campaign 2", lambda: abbe.compare([errors_of(FILES[0]), trunnion()])),
])
def test_bad_arguments_are_named(name, call, names_argument):
    names_argument(name, call)


@bad_input
def test_the_place_of_a_mistake_is_named(tmp_path):
    path = tmp_path / "bad.errors.toml"
    path.write_text('chain = "w X\' Y\' b Z t"\n\n[[location]]\nname = "EQ0Y"\nvalue_urad = 1\n')
    with pytest.raises(abbe.InputError) as error:
        abbe.compare([path, FILES[0]], machine=MILL)
    assert error.value.file == str(path) and error.value.line == 4 and "EQ0Y" in str(error.value)
    for campaigns in (None, 3, [3, 4], [None, FILES[0]], str(FILES[0])):
        with pytest.raises(TypeError):
            abbe.compare(campaigns, machine=MILL)


def test_distrusted_errors_are_told():
    text = FILES[0].read_text().replace('covariance = "march.covariance.csv"', 'distrusted = ["it does not fit"]')
    errors = abbe.Errors.parse(text, machine("three-axis-mill"))
    assert errors.distrusted == ["it does not fit"]
    with pytest.warns(UserWarning, match="march: marked as not to be trusted: it does not fit"):
        result = abbe.compare([errors, errors_of(FILES[2])], names=["march", "october"])
    assert any("it does not fit" in note for note in result.notes)


def test_progress_stops():
    def stop(*_):
        raise StopIteration

    def fail(*_):
        raise RuntimeError("of the user")

    many = [trunnion()] * 26
    with pytest.raises(abbe.Stopped):
        abbe.compare(many, progress=stop)
    with pytest.raises(RuntimeError, match="of the user"):
        abbe.compare(many, progress=fail)


def test_an_interruption_ends_a_comparison():
    many, finished = [trunnion()] * 26, []
    with pytest.raises(KeyboardInterrupt):
        threading.Timer(0.2, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
        finished.append(abbe.compare(many))
        threading.Event().wait(60)
    assert not finished
