"""Every test and every example in a docstring has a folder of its own."""

import os
import signal

os.environ.setdefault("MPLBACKEND", "Agg")
os.environ.setdefault("PYVISTA_OFF_SCREEN", "true")

import emmy
import pytest
from hypothesis import settings

from bodies import rubber, spinning_block

# The same examples in every run of CI; a run without this profile draws others.
settings.register_profile("repeatable", derandomize=True)


@pytest.fixture(autouse=True)
def own_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


@pytest.fixture(autouse=True)
def own_signals():
    """Gmsh replaces the handler of Ctrl-C by one that ends the process, until it is finalized."""
    yield
    signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.fixture
def beam():
    """A beam of 4 cells, held at its foot."""
    mesh = emmy.Mesh.box((1, 4, 1), (1, 4, 1))
    return emmy.Body(mesh, emmy.Region(rubber(), density=1.0), emmy.Support("y-min", fix="xyz"))


@pytest.fixture
def spinning():
    """A free block in rotation, with a plan."""
    return spinning_block()
