"""The notebooks run from their first cell to their last, as people run them; what they assert holds."""

import json
import os
import pathlib

import pytest
from use_examples import BUILD

import abbe

matplotlib = pytest.importorskip("matplotlib")
pytest.importorskip("matplotlib.pyplot")
pytest.importorskip("pandas")
FOLDER = pathlib.Path(__file__).resolve().parents[1] / "notebooks"
NOTEBOOKS = sorted(FOLDER.glob("*.ipynb"))


def code_of(notebook):
    """The cells of code, compiled."""
    found = []
    for number, cell in enumerate(json.loads(notebook.read_text(encoding="utf-8"))["cells"]):
        if cell["cell_type"] == "code":
            assert not cell["outputs"], "outputs are not kept in the repository"
            found.append(("".join(cell["source"]), f"{notebook.name}, cell {number}"))
    return found


def run(cells, names):
    matplotlib.use("Agg")
    for source, place in cells:
        exec(compile(source, place, "exec"), names)
    matplotlib.pyplot.close("all")


@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_compiles(notebook):
    assert code_of(notebook)


@pytest.mark.skipif(os.environ.get("ABBE_SITE_RUNS_NOTEBOOKS") == "1", reason="the test of the site runs them")
@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs(notebook, tmp_path, monkeypatch):
    if notebook.stem.startswith("paper_") and notebook.stem != "paper_liu" and not (BUILD / "bin/abbe-papers").exists():
        pytest.skip("abbe-papers is not built")
    monkeypatch.chdir(tmp_path)
    run(code_of(notebook), {"__name__": "__main__"})


def test_the_robot_is_calibrated_from_a_file(tmp_path, monkeypatch):
    cells = code_of(FOLDER / "six_axis_robot.ipynb")
    own = next(i for i, (source, _) in enumerate(cells) if "ABBE_ROBOT_READINGS" in source)
    names = {"__name__": "__main__"}
    run([*cells[:2], cells[own]], names)  # readings as the notebook simulates them
    some = names["table"].iloc[: len(names["table"]) // 2]
    some.to_csv(tmp_path / "readings.csv", index=False)
    monkeypatch.setenv("ABBE_ROBOT_READINGS", str(tmp_path / "readings.csv"))
    run([*cells[:1], *cells[own:]], names)
    assert len(names["table"]) == len(some) and names["identified"].trusted and names["after"] < 0.3 * names["before"]


def test_every_published_study_has_a_notebook():
    assert {path.stem for path in NOTEBOOKS} >= {f"paper_{paper}" for paper in abbe.PAPERS}
