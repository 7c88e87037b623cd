"""Names in the examples of docstrings."""

import os

import pytest


@pytest.fixture(autouse=True)
def names_of_examples(request, tmp_path, monkeypatch):
    """`emmy` and `np`, and a folder of its own for the files that an example writes."""
    if type(request.node).__name__ != "DoctestItem":
        return
    import emmy
    import numpy as np

    for package in ("gmsh", "matplotlib", "meshio", "pandas", "pyvista", "scipy"):
        if package in request.node.dtest.docstring:
            pytest.importorskip(package)
    monkeypatch.chdir(tmp_path)
    request.node.dtest.globs.update(emmy=emmy, np=np)
    assert os.listdir() == []
