"""Results of runs, read from their directories."""

from __future__ import annotations

import csv
import json
import os
import xml.etree.ElementTree as xml
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, overload

import numpy as np
from numpy.typing import NDArray

from . import _notebook
from . import _words as words
from ._errors import ResultsError, fault, missing, regular
from ._history import LIMITS, WHOLE, Event, History, structured


class Frame:
    """A frame of a run: the fields at one time.

    Attributes
    ----------
    time : float
        Time.
    path : pathlib.Path or None
        File: a `.vtu` file, or the `.vtkhdf` file of all frames; None for a frame in memory.

    Examples
    --------
    >>> emmy.Frame(0.5, "flight/frames/flight_000005.vtu").time
    0.5
    """

    def __init__(self, time: float, path: str | os.PathLike[str] | None, index: int | None = None) -> None:
        self.time = time
        self.path: Path | None = None if path is None else Path(path)
        self._index = index

    @property
    def displacement(self) -> NDArray[Any]:
        """The field ``displacement``, array (n, 3)."""
        return self.field("displacement")

    @property
    def velocity(self) -> NDArray[Any]:
        """The field ``velocity``, array (n, 3)."""
        return self.field("velocity")

    def field(self, name: str) -> NDArray[Any]:
        """A field of the frame.

        Parameters
        ----------
        name : str
            Name of a field that was written or kept.

        Returns
        -------
        array (n,) or (n, components)
            Values at the nodes, or in the cells.

        Raises
        ------
        ImportError
            If the frame is in a file, and PyVista is not installed.
        InputError
            If the frame does not have the field.

        Examples
        --------
        >>> mesh = emmy.Mesh.box((1, 1, 1), (1, 1, 1))
        >>> body = emmy.Body(mesh, emmy.Region(emmy.NeoHooke(lambda_=1, mu=1), density=1))
        >>> motion = emmy.Motion(body, steps=(1.0, 0.5), initial=emmy.Initial(velocity=(0, 0, 1)))
        >>> history = motion.run(every=1)
        >>> motion.frames[1].field("displacement")[0].round(12).tolist()
        [0.0, 0.0, 0.5]
        """
        fields = self._arrays()
        if name not in fields:
            raise fault("name", f"the frame has no field {name!r}; there is {', '.join(fields)}")
        return np.array(fields[name])

    def _arrays(self) -> Mapping[str, Any]:
        grid = self.to_pyvista()
        return {name: data[name] for data in (grid.point_data, grid.cell_data) for name in data.keys()}

    def to_pyvista(self) -> Any:
        """The frame as a grid of PyVista.

        Returns
        -------
        pyvista.UnstructuredGrid

        Raises
        ------
        ImportError
            If PyVista is not installed.

        Examples
        --------
        >>> mesh = emmy.Mesh.box((1, 1, 1), (1, 1, 1))
        >>> body = emmy.Body(mesh, emmy.Region(emmy.NeoHooke(lambda_=1, mu=1), density=1))
        >>> motion = emmy.Motion(body, steps=(1.0, 0.5), initial=emmy.Initial(velocity=(0, 0, 1)))
        >>> history = motion.run(output="flight")
        >>> grid = emmy.Run("flight").frames[-1].to_pyvista()
        >>> round(float(grid.point_data["displacement"][0, 2]), 12)
        1.0
        """
        try:
            import pyvista
        except ImportError:
            raise missing("to_pyvista", "PyVista", "emmy-fem[pyvista]") from None
        assert self.path is not None
        if self._index is None:
            return pyvista.read(regular(self.path))
        reader = _series(self.path)
        reader.SetStep(self._index)
        reader.Update()
        return pyvista.wrap(reader.GetOutput())

    def __repr__(self) -> str:
        return f"<emmy.Frame: t = {self.time:.6g}, {'in memory' if self.path is None else self.path}>"


class KeptFrame(Frame):
    """A frame in memory."""

    def __init__(self, time: float, number: int, fields: Mapping[str, NDArray[Any]], grid: Callable[[], Any]) -> None:
        super().__init__(time, None)
        #: Number of the step at whose end it was kept.
        self.number = number
        self._kept, self._grid = fields, grid

    def _arrays(self) -> Mapping[str, Any]:
        return self._kept

    def to_pyvista(self) -> Any:
        return self._grid()


#: Times that differ by less than this part of the largest one are equal.
ROUNDING = 1e-9

NO_FRAMES = "there are no frames; `every` of `Motion.run` keeps or writes them"


class Frames(Sequence[Frame]):
    """The frames of a run, in the order of their times.

    Examples
    --------
    >>> frames = emmy.Frames([emmy.Frame(0.0, "a.vtu"), emmy.Frame(0.5, "b.vtu")])
    >>> frames.times.tolist(), frames[-1].time, frames.at(0.5).path.name
    ([0.0, 0.5], 0.5, 'b.vtu')
    """

    def __init__(self, frames: Sequence[Frame]) -> None:
        self._frames = list(frames)

    @property
    def times(self) -> NDArray[np.float64]:
        """Times of the frames."""
        return np.array([frame.time for frame in self._frames])

    @property
    def displacement(self) -> NDArray[Any]:
        """The field ``displacement`` in all frames, array (m, n, 3)."""
        return self.field("displacement")

    @property
    def velocity(self) -> NDArray[Any]:
        """The field ``velocity`` in all frames, array (m, n, 3)."""
        return self.field("velocity")

    def field(self, name: str) -> NDArray[Any]:
        """A field in all frames.

        Parameters
        ----------
        name : str
            Name of a field that was written or kept.

        Returns
        -------
        array (m, n) or (m, n, components)
            `Frame.field` of each of the m frames.

        Raises
        ------
        ImportError
            If a frame is in a file, and PyVista is not installed.
        InputError
            If there are no frames, or one does not have the field.

        Examples
        --------
        >>> mesh = emmy.Mesh.box((1, 1, 1), (1, 1, 1))
        >>> body = emmy.Body(mesh, emmy.Region(emmy.NeoHooke(lambda_=1, mu=1), density=1))
        >>> motion = emmy.Motion(body, steps=(1.0, 0.5), initial=emmy.Initial(velocity=(0, 0, 1)))
        >>> history = motion.run(every=1)
        >>> motion.frames.field("displacement")[:, 0, 2].round(12).tolist()
        [0.0, 0.5, 1.0]
        """
        if not self._frames:
            raise fault("name", NO_FRAMES)
        return np.stack([frame.field(name) for frame in self._frames])

    def at(self, time: float) -> Frame:
        """The frame at a time.

        Parameters
        ----------
        time : float
            Time of a frame; it may differ by rounding.

        Returns
        -------
        Frame

        Raises
        ------
        InputError
            If there is no frame at this time.
        TypeError
            If the time is not a number.

        Examples
        --------
        >>> frames = emmy.Frames([emmy.Frame(0.0, "a.vtu"), emmy.Frame(0.5, "b.vtu")])
        >>> frames.at(0.5).time
        0.5
        """
        own, times = words.real(time, "time"), self.times
        if not self._frames:
            raise fault("time", NO_FRAMES)
        distances = np.abs(times - own)
        index = int(np.argmin(distances))
        if distances[index] > ROUNDING * max(abs(own), float(np.abs(times).max())):
            raise fault("time", f"there is no frame at t = {own:.9g}; the nearest one is at t = {times[index]:.9g}")
        return self._frames[index]

    @overload
    def __getitem__(self, index: int) -> Frame: ...
    @overload
    def __getitem__(self, index: slice) -> Frames: ...
    def __getitem__(self, index: int | slice) -> Frame | Frames:
        return Frames(self._frames[index]) if isinstance(index, slice) else self._frames[index]

    def __len__(self) -> int:
        return len(self._frames)

    def __iter__(self) -> Iterator[Frame]:
        return iter(self._frames)

    def __repr__(self) -> str:
        return f"<emmy.Frames: {len(self)}>"


class Run:
    """The results of a run in a directory. Files are read when they are asked for.

    Parameters
    ----------
    directory : str or path
        Output directory of a run, which may still be running.

    Raises
    ------
    ResultsError
        If the directory holds no run.

    Examples
    --------
    >>> mesh = emmy.Mesh.box((1, 1, 1), (1, 1, 1))
    >>> body = emmy.Body(mesh, emmy.Region(emmy.NeoHooke(lambda_=1, mu=1), density=1))
    >>> motion = emmy.Motion(body, steps=(1.0, 0.25), initial=emmy.Initial(velocity=(0, 0, 1)))
    >>> history = motion.run(output="flight", every=2)
    >>> run = emmy.Run("flight")
    >>> run.history["time"].tolist(), run.frames.times.tolist(), run.summary["steps"]
    ([0.0, 0.25, 0.5, 0.75, 1.0], [0.0, 0.5, 1.0], 4)
    """

    def __init__(self, directory: str | os.PathLike[str]) -> None:
        self._directory = Path(directory)
        if not (self._directory / "history.csv").exists():
            raise ResultsError(f"{os.fspath(directory)} holds no run of Emmy: there is no history.csv")

    @property
    def directory(self) -> Path:
        """Directory of the run."""
        return self._directory

    @property
    def history(self) -> History:
        """`history.csv` as a structured array with `History.peak`."""
        return read_table(self._directory / "history.csv").view(History)

    @property
    def newton(self) -> NDArray[Any]:
        """`newton.csv` as a structured array: step, iteration, residual, target."""
        return read_table(self._directory / "newton.csv")

    @property
    def events(self) -> list[Event]:
        """Steps that were cut or rejected, supports and joints that were released, and more."""
        rows = read_rows(self._directory / "events.csv")[1:]
        return [Event(int(step), float(time), kind, message) for step, time, kind, message in rows]

    @property
    def summary(self) -> dict[str, Any]:
        """`summary.json`: the run in numbers.

        ``"largest_in_regions"`` has the largest stress of each region, ``"contacts"`` the largest force of each
        contact, and how often and when it touches.
        """
        own: dict[str, Any] = json.loads(_read(self._directory / "summary.json"))
        return own

    @property
    def status(self) -> str:
        """How it ended: "done", "interrupted", "no-convergence", "limit-exceeded", "failed"; or "running"."""
        return str(self.summary["status"])

    @property
    def accuracy(self) -> str:
        """Accuracy in time, as far as it is known: "estimated ...", "not estimated ..." or "coarse ...".

        Balances close with steps of any size, so they say nothing about it. Empty before the run has ended, and for a
        static analysis.
        """
        return self.summary.get("accuracy_in_time_text") or ""

    @property
    def report(self) -> Path:
        """Path of the report, a page for a browser."""
        return self._directory / "report.html"

    @property
    def input(self) -> Path:
        """Path of the input with all defaults."""
        return self._directory / "input.toml"

    @property
    def frames(self) -> Frames:
        """Frames in `.vtu` files, or in a `.vtkhdf` file, which PyVista reads."""
        for path in sorted(self._directory.glob("*.pvd")):
            entries = xml.fromstring(_read(path)).iter("DataSet")
            return Frames(
                [Frame(float(own.attrib["timestep"]), self._directory / own.attrib["file"]) for own in entries]
            )
        for path in sorted(self._directory.glob("*.vtkhdf")):
            return Frames([Frame(time, path, index) for index, time in enumerate(_times(_series(path)))])
        raise ResultsError(f"{self._directory} has no frames")

    def field(self, name: str, *, time: float | None = None) -> NDArray[Any]:
        """A field of the frame at a time.

        Parameters
        ----------
        name : str
            Name of a field in the frames.
        time : float, optional
            Time of a frame; the last one if not given.

        Returns
        -------
        array (n,) or (n, components)
            Values at the nodes, or in the cells.

        Raises
        ------
        ImportError
            If PyVista is not installed.
        InputError
            If there is no frame at this time, or it does not have the field.
        ResultsError
            If the run has no frames.

        Examples
        --------
        >>> mesh = emmy.Mesh.box((1, 1, 1), (1, 1, 1))
        >>> body = emmy.Body(mesh, emmy.Region(emmy.NeoHooke(lambda_=1, mu=1), density=1))
        >>> motion = emmy.Motion(body, steps=(1.0, 0.5), initial=emmy.Initial(velocity=(0, 0, 1)))
        >>> history = motion.run(output="flight")
        >>> emmy.Run("flight").field("displacement", time=0.5)[0].round(12).tolist()     # pyvista reads the file
        [0.0, 0.0, 0.5]
        """
        frames = self.frames
        frame = frames[-1] if time is None else frames.at(time)
        return frame.field(name)

    @property
    def _has_summary(self) -> bool:
        return (self._directory / "summary.json").exists()

    def __repr__(self) -> str:
        return f"<emmy.Run: {self._directory}{f', {self.status}' if self._has_summary else ''}>"

    def _repr_html_(self) -> str:
        return _notebook.run(self)


def _series(path: Path) -> Any:
    """A reader of the frames in a `.vtkhdf` file."""
    try:
        from vtkmodules.vtkIOHDF import vtkHDFReader
    except ImportError:
        raise missing("frames", "PyVista", "emmy-fem[pyvista]") from None
    reader = vtkHDFReader()
    reader.SetFileName(str(regular(path)))
    reader.UpdateInformation()
    return reader


def _times(reader: Any) -> list[float]:
    from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline

    return [float(time) for time in reader.GetOutputInformation(0).Get(vtkStreamingDemandDrivenPipeline.TIME_STEPS())]


def _read(path: Path) -> str:
    try:
        regular(path)
        return path.read_text(encoding="utf-8")
    except FileNotFoundError:
        raise ResultsError(f"{path} is missing") from None


def _whole_lines(path: Path) -> list[str]:
    """The lines of a table; the last line of a run that is writing may not be complete."""
    text = _read(path)
    return text[: text.rfind("\n") + 1].splitlines()


def stamp(path: Path) -> tuple[int, int, int] | None:
    """Tells a file from the one that is written in its place; None if there is no file."""
    try:
        own = path.stat()
    except (FileNotFoundError, NotADirectoryError):
        return None
    return own.st_ino, own.st_mtime_ns, own.st_size


def read_rows(path: Path) -> list[list[str]]:
    """Rows of a CSV file, the header among them."""
    return list(csv.reader(_whole_lines(path)))


def _number(value: str) -> str:
    return str(LIMITS.index(value)) if value in LIMITS else value or "nan"


def read_table(path: Path) -> NDArray[Any]:
    """A CSV file of numbers as a structured array; an empty value is NaN."""
    lines = _whole_lines(path)
    if not lines:
        raise ResultsError(f"{path} is still empty")
    names = next(csv.reader(lines[:1]))
    has_words = "limited_by" in names
    filled = [
        ",".join(_number(value) for value in line.split(","))
        if has_words or ",," in line or line.endswith(",")
        else line
        for line in lines[1:]
    ]
    rows = np.loadtxt(filled, delimiter=",", ndmin=2) if filled else np.zeros((0, len(names)))
    return structured(rows, [(name, name in WHOLE) for name in names])
