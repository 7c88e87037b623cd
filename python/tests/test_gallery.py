"""The scripts of the gallery, each in an interpreter of its own, with their pictures."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
GALLERY = ROOT / "python/gallery"
PICTURES = ROOT / "book/src/python"
SCRIPTS = sorted(path.stem for path in GALLERY.glob("*.py") if path.stem != "pictures")
LARGEST = 60_000


def names_of_pictures(script):
    return re.findall(r'^(?:finish|screenshot)\(\w+, "([\w-]+)"\)$', (GALLERY / f"{script}.py").read_text(), flags=re.M)


@pytest.mark.parametrize("script", SCRIPTS)
def test_script(script, tmp_path):
    for package in ("gmsh", "matplotlib", "PIL", "pyvista", "scipy"):
        pytest.importorskip(package)
    own = os.environ | {"EMMY_GALLERY": str(tmp_path), "PYVISTA_OFF_SCREEN": "true", "PYTHONPATH": str(GALLERY)}
    command = [sys.executable, str(GALLERY / f"{script}.py")]
    done = subprocess.run(command, cwd=tmp_path, env=own, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0 and "EmmyWarning" not in done.stderr, done.stdout + done.stderr
    pictures = {path.stem: path for path in tmp_path.iterdir() if path.suffix in (".svg", ".png")}
    assert sorted(pictures) == sorted(names_of_pictures(script)) != []
    for picture in pictures.values():
        assert 1000 < picture.stat().st_size < LARGEST, picture.name
        assert (PICTURES / picture.name).exists(), f"EMMY_GALLERY=book/src/python python python/gallery/{script}.py"


def test_every_script_has_prose_and_a_place_in_the_book():
    page = (ROOT / "book/src/python-gallery.md").read_text()
    for script in SCRIPTS:
        text = (GALLERY / f"{script}.py").read_text()
        assert text.startswith("# %% [markdown]\n# # "), script
        assert re.search(r"^ *assert ", text, flags=re.M), script
        assert f"python python/gallery/{script}.py" in page, script
        for name in names_of_pictures(script):
            assert re.search(rf"!\[[^\]]+\]\(python/{name}\.(svg|png)\)", page), name


def test_the_book_has_no_other_pictures():
    names = [name for script in SCRIPTS for name in names_of_pictures(script)]
    assert sorted(path.stem for path in PICTURES.iterdir()) == sorted(names)
