#!/usr/bin/env python3
"""Results of `abbe reproduce` against the papers and the reference numbers. Usage: published_test.py PAPER FOLDER

FOLDER is what `abbe reproduce PAPER -o FOLDER` wrote.
"""
import json
import pathlib
import sys

FILES = {".abbe-results", "figures", "report.html", "study", "summary.json", "tables"}
KEYS = ["agrees_with_reference", "citation", "conclusions", "details", "facts", "failures", "format", "paper",
        "published", "tables", "title", "wrong_in_print"]
COLUMNS = ["where", "unit", "paper", "here", "difference", "note"]


def near(value, expected, tolerance, place=""):
    assert abs(value - expected) <= tolerance, f"{place}: {value} is not {expected} +- {tolerance}"


def names_in(folder):
    return {path.name for path in folder.iterdir()}


def check_common_layout(folder, summary):
    """What is written for every paper: the same files, and the same keys in summary.json."""
    assert names_in(folder) == FILES, names_in(folder)
    assert sorted(summary) == KEYS, sorted(summary)
    assert summary["format"] == "abbe-reproduction/1"
    assert summary["agrees_with_reference"] is True
    assert summary["facts"]
    # The published numbers with their unit, and a file for every table.
    assert summary["published"]
    for row in summary["published"]:
        assert row["note"] != "", row
        assert all(column in row for column in COLUMNS), row
    for name, table in summary["tables"].items():
        assert "title" in table and isinstance(table["rows"], list), name
    assert names_in(folder / "tables") == {"published.csv", *(f"{name}.csv" for name in summary["tables"])}
    figures = names_in(folder / "figures")
    assert figures and all(name.endswith(".svg") for name in figures), figures
    assert names_in(folder / "study")


def check_files(folder, names):
    for name in names:
        assert (folder / name).is_file(), name


def check_aguado(summary, _):
    details, tables = summary["details"], summary["tables"]
    # Three offsets: 24 directions of the published model are unseen; C0 and Z0 (6) are not parameters here.
    assert details["reference"]["5000_noiseLT"]["parameters"] == 120
    assert details["reference"]["5000_noiseLT"]["rank"] == 102
    # Table 1: scipy finds the same ranks; what is not determined is not a failure of the solver.
    ranks = tables["table-1-rank"]["rows"]
    assert [row["determined"] for row in ranks] == [10, 12, 15, 40, 45, 45]
    assert [row["rotations_about_the_line"] for row in ranks] == [2, 2, 3, 8, 9, 9]
    assert [row["shared_with_the_pose"] for row in ranks] == [0, 4, 0, 0, 0, 6]
    for name in ("table-1", "table-2", "table-3", "strategies"):
        for row in tables[name]["rows"]:
            assert row["model"] == "paper" or row["converged"] == "yes", row


def check_wang(summary, _):
    details = summary["details"]
    assert details["mean_columns"]["equal_to_cut_off_mean"] == 20
    near(details["zero_pose_error_mm"]["degrees"][0], -5.400842140, 1e-8)
    x = details["dials"]["one_dial_grids"]["X"]
    near(x["printed_rms_bias_um"][0], 56.751, 1e-3)
    near(x["correct_rms_bias_um"][0], 0, 1e-9)
    assert details["dials"]["seen_by_the_papers_instruments"] == 33
    assert details["ball_bar_circular_deviation_um"]["displacements only"]["XY"] < 25
    assert details["populations_um"]["12^6, degrees as printed"]["poses"] == 2985984


def check_liu(summary, folder):
    details = summary["details"]
    for name, value in details["reference_difference_mm"].items():
        assert value < 1e-9, name
    assert details["recursion_difference_mm"]["as_worded"] > 1
    parts = details["table_3_in_um"]["parts"]
    near(parts[0]["before"]["rms_um"], 101.27, 4)  # which places the path visits decides the mean
    for part in parts:
        assert part["after"]["rms_um"] < 8, part["part"]
    # Calibrated with a cylinder 21 um larger than assumed, the sphere is 21 um short, as in the paper.
    near(details["variants"][3]["spheres"][2]["after"]["fitted_radius_mm"], 12.682, 2e-3)
    # Figures 7 and 8: the paper states limits of 10 and 1 nm; the clamping of Table 3 is found.
    assert not summary["failures"], summary["failures"]
    found = 0
    for row in summary["published"]:
        if row["where"].startswith(("Figure 7", "Figure 8")):
            found += 1
            assert row["here"] < 1e-3, row
        if row["where"].startswith("Table 3, workholding, tilt"):
            found += 1
            near(row["difference"], 0, 5e-3, row["where"])
    assert found >= 3, found
    check_files(folder, [
        "tables/clamping.csv", "tables/figure-9.csv", "figures/figure-4b.svg", "figures/figure-8.svg",
        "figures/figure-11b-lobes.svg", "study/calibrated.errors.toml", "study/clamping-readings.csv",
        "study/cross-cylinder/path.csv", "study/sphere-25/after.ply"])


def check_yin(summary, _):
    details = summary["details"]
    near(details["linkage"]["U"]["corrected"]["L_tA_mm"], -0.265, 1e-9)
    near(details["linkage"]["U"]["printed"]["L_tA_mm"], 0.53, 1e-9)
    near(details["positioning"]["table_to_workpiece"]["x_mm"], -73.896, 1e-9)
    contour = details["contour"]
    # An independent program predicted 14.0, 24.2, 5.2 um; the causes are put together in another way there.
    near(contour["across_the_curve"]["mean_um"], 14.0, 1.5)
    near(contour["across_the_curve"]["max_um"], 24.2, 2.5)
    near(contour["across_the_curve"]["standard_deviation_um"], 5.2, 1.0)
    near(contour["rms_by_monte_carlo_um"] / contour["rms_by_sensitivity_um"], 1, 0.05)
    assert contour["budget"][0]["cause"] == "placement of the workpiece"
    near(contour["L_tA_as_printed_um"], 217, 15)


def check_ma(summary, folder):
    details = summary["details"]
    for order in ("paperorder", "faceorder"):
        assert details["reference_difference"][order]["angle_arcsec"] < 1e-9
        assert details["reference_difference"][order]["length_mm"] < 1e-9
        for name, value in details["section_3_3"][order]["exact_stepwise"].items():
            assert value < (1e-11 if name.endswith("arcsec") else 1e-10), name
    near(details["section_3_3"]["paperorder"]["corrected"]["eps_z_arcsec"], 0.0351, 6e-5)
    assert details["rank"][0]["rank"] == 72
    assert details["rank"][1]["rank"] == 107
    assert details["rank"][1]["unknowns"] == 128
    assert len(details["two_mounts"]["gauge"]) == 21
    assert details["table_3"]["paper_after"]["eps_z_arcsec"] == 27.38
    check_files(folder, [
        "tables/table-1.csv", "tables/errors-46.csv", "tables/table-3.csv", "tables/figure-3.csv",
        "tables/figure-5.csv", "figures/figure-3a.svg", "figures/figure-3b.svg", "figures/figure-5-eps_x.svg",
        "study/section-3-3-readings-face-order.csv"])


CHECKS = {"aguado": check_aguado, "liu": check_liu, "ma": check_ma, "wang": check_wang, "yin": check_yin}

paper, results = sys.argv[1], pathlib.Path(sys.argv[2])
with open(results / "summary.json", encoding="utf-8") as file:
    found_summary = json.load(file)
check_common_layout(results, found_summary)
CHECKS[paper](found_summary, results)
