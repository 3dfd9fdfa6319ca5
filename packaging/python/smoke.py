"""Tries an installed wheel: the module, the command beside it, and that both give the same bytes."""
import json
import pathlib
import subprocess
import sys
import sysconfig
import tempfile

import numpy

import abbe

said = subprocess.run(["abbe", "--version"], check=True, capture_output=True, text=True).stdout
assert said == f"abbe {abbe.__version__}\n", said
assert sys.prefix in abbe.__file__, abbe.__file__
assert (pathlib.Path(abbe.__file__).parent / "_core.pyi").is_file() and (pathlib.Path(abbe.__file__).parent / "py.typed").is_file()

mill = abbe.Machine.from_chain("w X' Y' b Z t")
errors = abbe.Errors(mill)
errors.add_location("EC0Y", value_urad=20)
deviations = abbe.PoseModel(errors).deviations(abbe.positions(mill, Y_mm=[0.0, 200.0]))
assert numpy.allclose(deviations[:, 0], [0, -0.004]), deviations
try:
    abbe.Machine.parse("no machine")
except abbe.InputError as error:
    assert error.line == 1, error
else:
    raise AssertionError("bad input was taken")

# Studies that come with the wheel: the module's results are those of the command.
study = pathlib.Path(sysconfig.get_path("data")) / "share/abbe/examples/three_axis/interferometer.study.toml"
with tempfile.TemporaryDirectory() as folder:
    subprocess.run(["abbe", "run", study, "--output", f"{folder}/command", "--quiet"], check=True)
    abbe.Study.read(study).run().write(f"{folder}/module")
    for name in ("summary.json", "report.html"):
        same = (pathlib.Path(folder, "command", name).read_bytes() == pathlib.Path(folder, "module", name).read_bytes())
        assert same, f"{name} of module and command differ"

# Its companion and the data of the published studies are found.
for paper in ("ma", "liu"):
    done = subprocess.run(["abbe", "reproduce", paper, "--json"], check=True, capture_output=True, text=True)
    assert json.loads(done.stdout)["paper"] == paper
print(f"{said.strip()} on Python {sys.version.split()[0]} with NumPy {numpy.__version__}: as it should be")
