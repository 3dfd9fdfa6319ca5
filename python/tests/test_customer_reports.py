"""Customer reports and calibration certificates: the same bytes as the command, and figures as numbers."""

import datetime
import os
import shutil
import xml.etree.ElementTree

import abbe
import pytest
from use_examples import EXAMPLES, command

#: Also run under the address sanitizer (CMakeLists.txt).
bad_input = pytest.mark.bad_input

FOLDER = EXAMPLES / "customer_report"
UNCERTAINTY = {"instrument_um_per_m": 0.4, "environment_um": 0.3}
OPTIONS = ["--before", FOLDER / "before.csv", "--instrument-um-per-m", 0.4, "--environment-um", 0.3]
FACTS = {
    "number": "2026-117", "customer": {"name": "Example Tooling Ltd", "address": "1 Sample Street, Sampleton"},
    "machine": {"maker": "Sample Machines", "model": "SM 1000", "serial_number": "SM-0417"},
    "laboratory": {"name": "Sample Laboratory", "address": "2 Sample Street, Sampleton", "country": "DE"},
    "place": "Hall 3, Sampleton", "operator": "A. Tester", "date": datetime.date(2026, 11, 28), "temperature_degC": 20.3,
    "temperature_range_degC": (19.9, 20.8), "standard": "ISO 230-2:2014",
    "remarks": ["Axis X, middle of Y and Z.", "Corrected with a pitch error table between both measurements."],
    "tolerances": {"A_um": 6, "R_um": 4, "B_um": 2},
    "instruments": [{"name": name, "serial_number": number, "certificate": certificate, "valid_until": "2027-05-31"}
                    for name, number, certificate in (("Laser interferometer", "LI-2201", "K-2026-0815"),
                                                      ("Environment station", "ES-118", "K-2026-0816"))],
}


def evaluation(name, **more):
    return abbe.evaluate_positioning(FOLDER / f"{name}.csv", uncertainty=UNCERTAINTY, **more)


def positioning_report(**more):
    return abbe.customer_report(evaluation("after"), {**FACTS, **more}, before=evaluation("before"),
                                files=["before.csv", "after.csv"])


@pytest.fixture(scope="module")
def mill():
    return abbe.Study.read(FOLDER / "mill.study.toml").run()


@pytest.mark.parametrize("ending", ["html", "xml"])
def test_a_report_on_positioning_is_that_of_the_command(ending, tmp_path):
    asked = ["evaluate", "positioning", FOLDER / "after.csv", *OPTIONS, "--facts", FOLDER / "facts.toml",
             "--customer-report", f"wanted.{ending}"]
    report = positioning_report()
    command(asked, tmp_path, 1 if report.exceeded else 0)
    wanted = (tmp_path / f"wanted.{ending}").read_bytes()
    report.write(tmp_path / f"own.{ending}")
    assert (tmp_path / f"own.{ending}").read_bytes() == wanted
    assert (report.page_html() if ending == "html" else report.certificate_xml()).encode() == wanted
    of_file = abbe.customer_report(evaluation("after"), FOLDER / "facts.toml", before=evaluation("before"),
                                   files=["before.csv", "after.csv"])
    assert of_file.page_html() == report.page_html()
    with pytest.raises(FileExistsError):
        report.write(tmp_path / f"own.{ending}")
    report.write(tmp_path / f"own.{ending}", overwrite=True)


def test_a_report_on_a_study_is_that_of_the_command(mill, tmp_path):
    command(["run", FOLDER / "mill.study.toml", "-o", "results", "--quiet"], tmp_path)
    report = abbe.customer_report(mill)
    assert report.page_html() == (tmp_path / "results/customer-report.html").read_text()
    assert report.certificate_xml() == (tmp_path / "results/calibration-certificate.xml").read_text()
    assert not report.simulated and [state.no_verdict != "" for state in report.states] == [False, True]  # a prediction
    assert {figure.symbol for figure in report.figures} >= {"V_max", "V_mean"}


def test_a_study_before_and_after_a_correction(mill, tmp_path):
    mill.write(tmp_path / "before")
    memory = abbe.customer_report(mill, before=mill)
    folder = abbe.customer_report(mill, before=tmp_path / "before")
    errors = abbe.customer_report(mill, before=mill.errors)
    for report in (memory, folder, errors):
        assert [state.no_verdict for state in report.states] == ["", ""]  # both are measured
        for figure in report.figures:
            assert figure.values[0] == pytest.approx(figure.values[1], rel=1e-6, abs=1e-6)
    xml.etree.ElementTree.fromstring(abbe.customer_report(mill, FACTS | {"tolerances": {}}, before=mill).certificate_xml())


def test_figures_are_those_of_the_evaluation():
    after, report = evaluation("after"), positioning_report()
    by_symbol = {figure.symbol: figure for figure in report.figures}
    for symbol in ("A", "R", "B"):
        figure = by_symbol[symbol]
        assert figure.values[1] == pytest.approx(after[symbol].value) and len(figure.values) == 2
        assert figure.expanded_uncertainties[1] == pytest.approx(after[symbol].expanded_uncertainty)
        assert figure.tolerance == FACTS["tolerances"][f"{symbol}_um"] and figure.unit == "µm"
        guard = 1.65 * figure.expanded_uncertainties[1] / 2
        value, tolerance = abs(figure.values[1]), figure.tolerance
        wanted = "pass" if value + guard <= tolerance else "fail" if value - guard > tolerance else "noPass"
        assert figure.verdicts[1] == wanted
    assert by_symbol["E"].tolerance is None and by_symbol["E"].verdicts == ["", ""]
    assert [len(state.sentences) > 0 for state in report.states] == [True, True]
    assert not report.simulated and report.refusals == []
    strict = positioning_report(tolerances={"A_um": 0.01})
    assert strict.exceeded == "A" and strict.figures[0].verdicts[1] == "fail"


@pytest.mark.parametrize("language, word", [("de", "beidseitige Positioniergenauigkeit"), ("zh", "双向定位精度"),
                                            ("ja", "両方向位置決めの正確さ"), ("en", "bidirectional accuracy")])
def test_languages(language, word):
    report = positioning_report(language=language)
    assert report.language == language and word.lower() in report.page_html().lower()


def test_diagonals_and_no_facts(tmp_path):
    test = abbe.evaluate_diagonals(EXAMPLES / "evaluate/diagonals.csv")
    report = abbe.customer_report(test)
    assert report.states and "not stated" in report.page_html() and all(f.tolerance is None for f in report.figures)
    with pytest.raises(abbe.InputError, match="a certificate also needs number"):
        report.certificate_xml()
    with pytest.raises(abbe.InputError, match="a certificate also needs"):
        report.write(tmp_path / "certificate.xml")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(not (shutil.which("chromium") or os.environ.get("ABBE_BROWSER")), reason="needs Chromium")
def test_a_pdf_is_printed(tmp_path):
    report = positioning_report()
    report.write(tmp_path / "report.pdf")
    pdf = (tmp_path / "report.pdf").read_bytes()
    assert pdf.startswith(b"%PDF-") and pdf == report.pdf() and b"20261128" in pdf
    command(["evaluate", "positioning", FOLDER / "after.csv", *OPTIONS, "--facts", FOLDER / "facts.toml",
             "--customer-report", "wanted.pdf"], tmp_path, 1 if report.exceeded else 0)
    assert (tmp_path / "wanted.pdf").read_bytes() == pdf


def test_without_a_browser_there_is_no_pdf(tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv("ABBE_BROWSER", raising=False)
    report = positioning_report()
    with pytest.raises(abbe.InputError, match="pdf: not printed"):
        report.write(tmp_path / "report.pdf")
    with pytest.raises(abbe.InputError, match="chromium"):
        report.pdf()
    assert list(tmp_path.iterdir()) == []


@bad_input
@pytest.mark.parametrize("facts, field", [
    ({"language": "fr"}, "facts.language"), ({"date": "28.11.2026"}, "facts.date"), ({"surprise": 1}, "facts.surprise"),
    ({"temperature_degC": 400}, "facts.temperature_degC"), ({"tolerances": {"A_um": -1}}, "facts.tolerances.A_um"),
    ({"tolerances": {"Q_um": 1}}, "facts.tolerances.Q_um"), ({"tolerances": {"A_mm2": 1}}, "facts.tolerances.A_mm2"),
    ({"customer": "Example"}, "facts.customer"), ({"instruments": [{"serial_number": "1"}]}, "facts.instruments[1].name"),
])
def test_wrong_facts_are_named(facts, field):
    with pytest.raises(abbe.InputError) as error:
        abbe.customer_report(evaluation("after"), facts)
    assert error.value.field == field and error.value.line is None


def test_every_kind_of_evaluation_has_a_report():
    straight = abbe.evaluate_straightness({"position_mm": [0, 1, 2, 3], "deviation_um": [0, 1, 1, 0]})
    report = abbe.customer_report(straight, {key: value for key, value in FACTS.items() if key != "tolerances"})
    assert [figure.symbol for figure in report.figures] == list(straight.figures)


@bad_input
def test_mistakes_are_named(mill, tmp_path):
    after, report = evaluation("after"), positioning_report()
    for name in ("report", "report.txt", "report.PDF", ""):
        with pytest.raises(abbe.InputError, match="path"):
            report.write(tmp_path / name if name else name)
    with pytest.raises(abbe.InputError, match="two tolerances"):
        abbe.customer_report(evaluation("after", tolerances={"A_um": 6}), FACTS)
    with pytest.raises(abbe.InputError, match="before: the readings are of another test"):
        abbe.customer_report(after, before=abbe.evaluate_diagonals(EXAMPLES / "evaluate/diagonals.csv"))
    with pytest.raises(abbe.InputError, match="missing.toml"):
        abbe.customer_report(after, tmp_path / "missing.toml")
    with pytest.raises(abbe.InputError, match="facts"):
        abbe.customer_report(mill, {"tolerances": {"A_um": 6}})
    with pytest.raises(abbe.InputError, match="also needs"):
        abbe.customer_report(mill, {"laboratory": {"name": "Sample Laboratory"}})
    with pytest.raises(abbe.InputError, match="before"):
        abbe.customer_report(mill, before=abbe.Errors(abbe.Machine.from_chain("w C' X' b Z t")))
    for bad in (lambda: abbe.customer_report(3), lambda: abbe.customer_report(after, before=mill),
                lambda: abbe.customer_report(mill, before=after), lambda: abbe.customer_report(after, 3),
                lambda: abbe.customer_report(mill, files=["a.csv"]), lambda: abbe.customer_report(after, files="a.csv"),
                lambda: abbe.customer_report(None)):
        with pytest.raises(TypeError):
            bad()


def test_a_study_without_facts_wants_some():
    study = abbe.Study(abbe.Machine.from_chain("w X' Y' b Z t"), {
        "simulate": {"generator": {"seed": 1, "mean_volumetric_um": 20}},
        "setup": [{"name": "bar", "instrument": "ball-bar", "spindle_ball_mm": [0, 0, -100],
                   "ball": [{"name": "table", "centre_mm": [0, 0, 0]}], "noise": {"length_um": 0.5},
                   "plan": [{"kind": "circle", "plane": ["X", "Y"], "radius_mm": 100, "points": 60}]}],
        "identify": {"locations": ["EC0Y"]}})
    result = study.run(map=False)
    with pytest.raises(abbe.InputError, match="facts"):
        abbe.customer_report(result)
    report = abbe.customer_report(result, {"tolerances": {"EC0Y_urad": 100}, "language": "de"})
    [figure] = [figure for figure in report.figures if figure.symbol == "EC0Y"]
    assert figure.tolerance == 100 and figure.unit == "µrad" and figure.verdicts == ["", ""] and report.simulated
