"""Studies as objects: made in code or read from files, run, planned, and written as TOML."""

from __future__ import annotations

import copy
import os
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, Union

import tomli_w

from . import _core
from ._core import Errors, Evaluation, Instrument, Machine, Readings, StudyCheck, StudyPlan, StudyResult, VerifiedReadings

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

# Parquet and Arrow files are read with the pyarrow of this Python.
if sys.executable:
    os.environ.setdefault("ABBE_COLUMNS_PYTHON", sys.executable)

Progress = Union[Callable[[str, int, int], object], None]
PathLike = Union[str, "os.PathLike[str]"]


class Study:
    """A whole job: what is measured or simulated, what is identified, and what is reported.

    ``document`` has the tables of a study file (docs/formats.md) as dictionaries and lists. It is checked at once against
    the machine. Paths in it are relative to ``folder``.

    >>> import abbe
    >>> mill = abbe.Machine.from_chain("w X' Y' b Z t")
    >>> study = abbe.Study(mill, {
    ...     "simulate": {"generator": {"seed": 3, "mean_volumetric_um": 20}},
    ...     "setup": [{
    ...         "name": "bar", "instrument": "ball-bar", "spindle_ball_mm": [0, 0, -100],
    ...         "ball": [{"name": "table", "centre_mm": [0, 0, 0]}], "noise": {"length_um": 0.1},
    ...         "plan": [{"kind": "circle", "plane": [a, b], "radius_mm": 100, "points": 60}
    ...                  for a, b in ("XY", "YZ", "XZ")],
    ...     }],
    ...     "identify": {"locations": ["EC0Y", "EA0Z", "EB0Z"]},
    ... })
    >>> study.run().names[:3]
    ['EC0Y', 'EA0Z', 'EB0Z']

    Raises :class:`abbe.InputError` with the field that is wrong.
    """

    def __init__(self, machine: Machine, document: Mapping[str, Any], *, folder: PathLike = ".", name: str = "study") -> None:
        self._document: dict[str, Any] = copy.deepcopy(dict(document))
        self._document.setdefault("machine", f"{name}.machine.toml")
        self._folder = Path(folder)
        self._file = f"{name}.study.toml"
        self._data = _core.StudyData.parse(self.text(), self._folder / self._file, machine)

    @classmethod
    def read(cls, path: PathLike) -> Study:
        """A study from a file (``*.study.toml``) and the machine file it names. Raises :class:`abbe.InputError`."""
        path = Path(path)
        data = _core.StudyData.read(path)
        study = cls.__new__(cls)
        study._document = tomllib.loads(path.read_text(encoding="utf-8-sig"))
        study._folder, study._file, study._data = path.parent, path.name, data
        return study

    @classmethod
    def parse(cls, text: str, machine: Machine, *, folder: PathLike = ".", name: str = "study") -> Study:
        """A study from the text of a study file, for a machine that is already there."""
        study = cls.__new__(cls)
        study._folder, study._file = Path(folder), f"{name}.study.toml"
        study._data = _core.StudyData.parse(text, study._folder / study._file, machine)
        study._document = tomllib.loads(text)
        return study

    @property
    def name(self) -> str:
        """Name of the study."""
        return self._data.name

    @property
    def machine(self) -> Machine:
        """A copy of the machine."""
        return self._data.machine

    @property
    def simulated(self) -> bool:
        """Whether the readings are simulated."""
        return self._data.simulated

    @property
    def instruments(self) -> dict[str, Instrument]:
        """The instruments by the names of their set-ups."""
        return {instrument.name: instrument for instrument in self._data.instruments()}

    def to_dict(self) -> dict[str, Any]:
        """The document, a copy that can be changed and made into another study."""
        return copy.deepcopy(self._document)

    def text(self) -> str:
        """Text of a study file; :meth:`parse` gives back the same study."""
        return tomli_w.dumps(self._document)

    def write(self, folder: PathLike, overwrite: bool = False) -> Path:
        """Writes the study file and the machine file that it names into a folder, and returns the path of the first.

        Existing files are only replaced with ``overwrite=True``. Other files that the study names are not copied.
        """
        folder = Path(folder)
        study, machine = folder / self._file, folder / str(self._document["machine"])
        if machine.resolve().parent != folder.resolve():
            raise _core_input_error("machine", f"'{self._document['machine']}' leads out of the folder", "a name without a folder")
        if not overwrite:
            for path in (study, machine):
                if path.exists() or path.is_symlink():
                    raise FileExistsError(f"{path} is there already; it is only replaced with overwrite=True")
        self.machine.write(machine, overwrite=overwrite)
        _core.write_text(study, self.text(), overwrite)
        return study

    def run(self, readings: Mapping[str, Readings] | None = None, *, truth: Errors | None = None,
            accept_misfit: bool = False, map: bool = True, advice: bool = True,
            progress: Progress = None) -> StudyResult:
        """Reads or simulates the readings, identifies, validates, judges the result and maps the volumetric error.

        ``readings``: by set-up, in place of its files. ``truth``: errors behind simulated readings, in place of the
        study's. ``accept_misfit``: the result is to be used although it is distrusted. ``map=False``: no map.
        ``advice=False``: not computed is which measurement would show what these readings leave open, which takes most
        of the time of a small study.
        ``progress(step, done, total)`` is called from time to time; Ctrl-C stops the study. Nothing is written.
        """
        return _core.StudyData.run(self._data, dict(readings or {}), truth, accept_misfit, map, advice, progress)

    def gather(self, readings: Mapping[str, Readings] | None = None, *, truth: Errors | None = None,
               progress: Progress = None) -> dict[str, Readings]:
        """The readings alone, by set-up: read from files or simulated."""
        return self._data.gather(dict(readings or {}), truth, progress)

    def plan(self, *, progress: Progress = None) -> StudyPlan:
        """Chooses the readings that determine the errors best; the study has a ``plan`` table."""
        return self._data.plan(progress)

    def check(self, readings: Mapping[str, Readings] | None = None, *, truth: Errors | None = None,
              progress: Progress = None) -> StudyCheck:
        """Whether the nominal machine explains the readings, and which mistake would if not; nothing is identified.

        ``readings`` and ``truth`` as in :meth:`run`. Found are, for example, mirrored coordinates, a clockwise azimuth,
        zenith angles, swapped or reversed axes, wrong units and a station that moved. ``progress(step, done, total)`` is
        called while readings are read or simulated; Ctrl-C takes effect then. Raises :class:`abbe.InputError`.

        >>> import abbe, numpy
        >>> mill = abbe.Machine.from_chain("w X' Y' b Z t")
        >>> study = abbe.Study(mill, {"setup": [{
        ...     "name": "room", "instrument": "tracker", "noise": {"xyz_um": 5},
        ...     "station": [{"name": "left", "pose": "find"}], "reflector": [{"name": "spindle", "offset_mm": [0, 0, 0]}]}]})
        >>> commands = abbe.grid(mill, X_mm=[-200, 0, 150], Y_mm=[-100, 0, 200], Z_mm=[-100, 0, 50])
        >>> points = abbe.nominal_poses(mill, commands).points_mm
        >>> tracker = study.instruments["room"]
        >>> study.check({"room": abbe.Readings(tracker, commands, points)}).explained
        True
        >>> swapped = study.check({"room": abbe.Readings(tracker, commands, points[:, [1, 0, 2]])})
        >>> swapped.explained, len(swapped.unexplained)
        (False, 1)
        """
        return self._data.check(dict(readings or {}), truth, progress)

    def verify(self, errors: Errors, readings: Mapping[str, Readings] | None = None, *, truth: Errors | None = None,
               least_reduction: float | None = None, largest_ratio: float | None = None,
               errors_file: str = "errors.toml", progress: Progress = None) -> VerifiedReadings:
        """What identified errors leave of readings that took no part in their identification: ``abbe verify --readings``.

        ``errors``: of this machine, with their covariance if it is known. ``readings`` and ``truth`` as in :meth:`run`.
        The unknowns of the set-ups are fitted to the readings while the errors are held. ``least_reduction``: how many
        times smaller the mean residual must become. ``largest_ratio``: limit of the residual divided by what the
        uncertainties explain, both root mean square. ``errors_file``: the name of the errors in texts.
        ``progress(step, done, total)`` is called after each of three steps; Ctrl-C takes effect then. Raises
        :class:`abbe.InputError`, also for readings that do not determine where the instruments stood, and warns of errors
        that are marked as not to be trusted.

        >>> import abbe, numpy
        >>> mill = abbe.Machine.from_chain("w X' Y' b Z t")
        >>> study = abbe.Study(mill, {"setup": [{
        ...     "name": "bar", "instrument": "ball-bar", "spindle_ball_mm": [0, 0, -100],
        ...     "ball": [{"name": "table", "centre_mm": [0, 0, 0]}], "noise": {"length_um": 0.2}}]})
        >>> turn = numpy.radians(numpy.arange(0, 360, 6))
        >>> commands = abbe.positions(mill, X_mm=100 * numpy.cos(turn), Y_mm=100 * numpy.sin(turn), Z_mm=100)
        >>> truth, identified = abbe.Errors(mill), abbe.Errors(mill)
        >>> truth.add_location("EC0Y", value_urad=30)
        >>> identified.add_location("EC0Y", value_urad=29, u_urad=1)
        >>> october = abbe.Readings(study.instruments["bar"], commands).simulate(truth, seed=10)
        >>> result = study.verify(identified, {"bar": october}, least_reduction=3)
        >>> result.says_no, [verdict.name for verdict in result.verdicts]
        (False, ['improvement', 'consistency', 'reduction'])
        """
        return self._data.verify(errors, dict(readings or {}), truth, least_reduction, largest_ratio, errors_file, progress)

    def location_distortion(self, readings: Mapping[str, Readings] | None = None, *, truth: Errors | None = None,
                            options: Mapping[str, float] | None = None,
                            tolerances: Mapping[str, float] | None = None) -> Evaluation:
        """Location errors while the machine is heated and cools (ISO 230-3): ``abbe evaluate location-distortion``.

        The poses of the study are measured repeatedly; the readings have times. ``readings`` and ``truth`` as in
        :meth:`run`. ``options``: numbers named like the options of the command: ``cycle_min`` or ``pause_min`` say what a
        cycle is, ``start_min`` and ``stop_min`` when the machine is heated. ``tolerances``: ``{"d_EX0C_um": 10}``.
        ``numbers`` of the result is a LocationDistortionNumbers. Raises :class:`abbe.InputError`.
        Definitions: docs/evaluate-thermal.md.
        """
        return self._data.location_distortion(dict(readings or {}), truth, dict(options or {}), dict(tolerances or {}),
                                              self._file)

    def __repr__(self) -> str:
        kind = "simulated" if self.simulated else "measured"
        return f"<abbe.Study '{self.name}' of {self.machine.chain}: {kind}, set-ups {', '.join(self.instruments) or 'none'}>"


def _core_input_error(field: str, problem: str, expected: str) -> Exception:
    from ._errors import InputError

    return InputError(f"{field}: {problem}; expected {expected}", field=field, problem=problem, expected=expected)


def instrument(kind: str, machine: Machine, *, name: str | None = None, **settings: Any) -> Instrument:
    """An instrument on a machine; the settings are the keys of its set-up in a study file (docs/formats.md).

    ``kind`` is one of ``abbe.INSTRUMENTS``.

    >>> import abbe
    >>> mill = abbe.Machine.from_chain("w X' Y' b Z t")
    >>> bar = abbe.instrument("ball-bar", mill, spindle_ball_mm=[0, 0, -100],
    ...                       ball=[{"name": "table", "centre_mm": [0, 0, 0]}], noise={"length_um": 0.1})
    >>> bar.components
    ['length_mm']
    """
    return Instrument._parse(tomli_w.dumps(settings), kind, name or kind, machine)
