"""Pages in notebooks, and progress."""

import re
import sys
from html.parser import HTMLParser
from pathlib import Path
from xml.etree import ElementTree

import emmy
import numpy as np
from emmy import _notebook

from bodies import spinning_block


class Balanced(HTMLParser):
    """Checks that every tag is closed."""

    def __init__(self):
        super().__init__()
        self.open = []

    def handle_starttag(self, tag, attributes):
        if tag not in ("br",):
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag


def checked(page):
    parser = Balanced()
    parser.feed(page)
    assert parser.open == []
    pictures = re.findall(r"<svg.*?</svg>", page, flags=re.DOTALL)
    for picture in pictures:
        for line in ElementTree.fromstring(picture).iter("polyline"):
            places = np.array([point.split(",") for point in line.attrib["points"].split()], dtype=float)
            assert np.all((places >= 0) & (places <= [_notebook.WIDTH, _notebook.HEIGHT]))
    return len(pictures)


def test_motion(spinning):
    assert checked(spinning._repr_html_()) == 0
    history = spinning.run()
    page = spinning._repr_html_()
    assert checked(page) == 2
    worst = np.abs(history["energy_residual"]).max()
    largest = (history["kinetic_energy"] + np.abs(history["strain_energy"])).max()
    assert f"worst energy residual of a step {worst / largest:.1e}" in page


def test_run(spinning):
    spinning.run(output="out")
    page = emmy.Run("out")._repr_html_()
    assert checked(page) == 2
    assert "<iframe srcdoc=" in page and "done" in page
    assert emmy.Run("out").accuracy == spinning.accuracy and f"accuracy in time: {spinning.accuracy}" in page


def test_a_run_that_has_just_begun(spinning, tmp_path):
    spinning.run(output="out")
    summary, history = Path("out/summary.json"), Path("out/history.csv")
    summary.unlink()
    page = emmy.Run("out")._repr_html_()
    assert checked(page) == 2 and page.startswith("<div><p><b>emmy.Run</b>: out<br>")
    history.write_text(history.read_text().splitlines()[0] + "\n")
    assert "<b>emmy.Run</b>: out<br>no step yet" in emmy.Run("out")._repr_html_()
    history.write_text("")
    assert emmy.Run("out")._repr_html_() == "&lt;emmy.Run: out&gt;"


def test_no_peak_is_lost():
    values = np.zeros(100_000)
    values[61_803] = 1.0
    chosen = _notebook._fewer(values)
    assert len(chosen) <= _notebook.MOST_POINTS and 61_803 in chosen


def test_progress_without_tqdm(monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "tqdm.auto", None)
    spinning_block().run(progress=True)
    captured = capsys.readouterr()
    assert captured.out == "" and "t 1 of 1  step 20" in captured.err


def test_progress_with_tqdm(capsys):
    import pytest

    pytest.importorskip("tqdm")
    spinning_block().run(progress=True)
    captured = capsys.readouterr()
    assert captured.out == "" and "100%" in captured.err


def test_nothing_is_printed(capfd, spinning):
    spinning.run(output="out")
    emmy.new("l-block")
    emmy.run("l-block.toml", until=0.05)
    emmy.check("l-block.toml")
    captured = capfd.readouterr()
    assert captured.out == "" and captured.err == ""


def test_a_body_at_rest_under_its_weight_closes():
    mesh = emmy.Mesh.box((1, 2, 1), (1, 2, 1))
    rubber = emmy.Region(emmy.NeoHooke(lambda_=1000, mu=500), density=2)
    hanging = emmy.Body(mesh, rubber, emmy.Support("y-min", fix="xyz"), emmy.Load(acceleration=(3, 0, -9.81)))
    motion = emmy.Motion(hanging, steps=(0.5, 0.1), equilibrium=True)
    motion.run()
    own = re.search(r"angular momentum residual (\S+) of the largest possible value", motion._repr_html_())
    assert own and float(own[1]) < 1e-12
