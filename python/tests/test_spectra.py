"""Spectra against SciPy, and harmonic responses against closed forms."""

import emmy
import numpy as np
import pytest

TIME = 0.02 * np.arange(300)
NOISE = np.random.default_rng(7)
X = NOISE.standard_normal(300)
Y = 2.0 * np.roll(X, 3) + NOISE.standard_normal(300)


def test_averages_are_those_of_scipy():
    signal = pytest.importorskip("scipy.signal")
    for window in ("hann", "boxcar", "flattop", "blackman"):
        for segment, overlap, detrend in ((64, None, "constant"), (33, 8, "linear"), (300, 0, "none")):
            given = {"window": window, "nperseg": segment, "noverlap": overlap}
            trend = False if detrend == "none" else detrend
            frequencies, density = signal.welch(X, 50.0, detrend=trend, **given)
            found = emmy.spectrum(TIME, X, window=window, segment=segment, overlap=overlap, detrend=detrend)
            assert np.allclose(found["frequency"], frequencies, rtol=1e-12)
            assert np.allclose(found["psd"], density, rtol=1e-11, atol=1e-16)
    found = emmy.spectrum(TIME, Y, input=X, kind="frf", segment=64)
    gain = signal.csd(X, Y, 50.0, nperseg=64)[1] / signal.welch(X, 50.0, nperseg=64)[1]
    assert np.allclose(found["amplitude"] * np.exp(1j * found["phase"]), gain, rtol=1e-11)
    assert np.allclose(found["coherence"], signal.coherence(X, Y, 50.0, nperseg=64)[1], rtol=1e-11)


def test_leading_gaps_are_left_out():
    gap = np.concatenate([[np.nan, np.nan], Y[2:]])
    whole = emmy.spectrum(TIME[2:], Y[2:], input=X[2:], kind="frf", segment=64)
    np.testing.assert_array_equal(emmy.spectrum(TIME, gap, input=X, kind="frf", segment=64), whole)
    with pytest.raises(emmy.InputError, match="values: must be finite"):
        emmy.spectrum(TIME, np.concatenate([Y[:5], [np.nan], Y[6:]]))


def test_shock_responses_and_uneven_times():
    # A step: an oscillator without damping overshoots to twice the acceleration.
    found = emmy.spectrum(1e-3 * np.arange(1000), np.ones(1000), kind="srs", frequencies=[2.0, 5.0], q=1e12)
    assert found.dtype.names[:2] == ("frequency", "acceleration_maximax") and len(found.dtype.names) == 7
    assert found["acceleration_maximax"] == pytest.approx([2.0, 2.0], rel=1e-3)
    assert found["displacement_negative"][1] * (10 * np.pi) ** 2 == pytest.approx(2.0, rel=1e-3)
    times = np.concatenate([TIME, TIME[-1] + 0.01 * np.arange(1, 4)])
    with pytest.warns(emmy.EmmyWarning, match="interpolated"):
        assert len(emmy.spectrum(times, times, kind="amplitude")) == 151


def oscillator(**given):
    """A mass of 0.5 on a spring of stiffness 18 along x."""
    mesh = emmy.Mesh.network([(0, 0, 0), (1, 0, 0)], [(0, 1)], groups={"foot": [0], "head": [1]})
    supports = [emmy.Support("foot", fix="xyz"), emmy.Support("head", fix="yz")]
    spring = emmy.Region(emmy.Spring(stiffness=18.0))
    return emmy.Body(mesh, spring, supports, masses=emmy.Mass("head", mass=0.5), **given)


def test_an_oscillator_responds_in_closed_form():
    body = oscillator(loads=[emmy.Load("head", nodal_force=(1.0, 0, 0)), emmy.Load("head", nodal_force=(2.0, 0, 0))])
    f = np.array([0.1, 0.9, 6.0 / (2 * np.pi), 2.0])
    omega = 2 * np.pi * f
    gain = 1 / (18.0 - 0.5 * omega**2 + 1j * omega * 2 * 0.05 * 3.0)
    found = emmy.response(body, f, damping=0.05, count=1, nodes=[1])
    assert np.allclose(found.amplitudes[:, 0], np.outer(3.0 * gain, [1, 0, 0]), rtol=1e-10)
    assert found.damping_ratios == pytest.approx([0.05]) and found.natural_frequencies == pytest.approx([3 / np.pi])
    single = emmy.response(body, f, damping=[0.05], count=1, loads=[1], quantity="velocity")
    assert np.allclose(single.amplitudes[:, 1, 0], 2j * omega * gain, rtol=1e-10) and single.nodes.tolist() == [0, 1]
    base = {"base": "x", "damping": 0.05, "count": 1, "quantity": "acceleration"}
    transmitted = (18.0 + 1j * omega * 0.3) * gain
    assert np.allclose(emmy.response(body, f, **base).amplitudes[:, 1, 0], transmitted, rtol=1e-10)
    relative = emmy.response(body, f, relative=True, **base).amplitudes[:, 1, 0]
    assert np.allclose(relative, transmitted - 1.0, rtol=1e-9)


def test_stresses_of_a_pillar():
    """The stress at the foot of a pillar under a slow tension p is p / cos(k L), k L = pi f / (2 f_1)."""
    rubber = emmy.Region(emmy.NeoHooke(lambda_=0.0, mu=500.0), density=0.1)
    supports = [emmy.Support(f"{axis}-min", fix=axis) for axis in "xyz"]
    load = emmy.Load("z-max", traction=(0.0, 0.0, 3.0))
    body = emmy.Body(emmy.Mesh.box((1, 1, 2), (1, 1, 8)), rubber, supports, loads=load)
    f = np.array([2.0, 8.0])
    foot = int(np.argmin(np.linalg.norm(body.mesh.points, axis=1)))
    given = {"damping": 1e-4, "count": 40, "nodes": [foot]}
    found = emmy.response(body, f, quantity="cauchy_stress", **given).amplitudes
    assert found.shape == (2, 1, 6)
    assert np.abs(found[:, 0, 2]) == pytest.approx(3.0 / np.cos(0.5 * np.pi * f / 12.5), rel=0.01)
    assert np.abs(found[:, 0, [0, 1, 3, 4, 5]]).max() < 1e-6


@pytest.mark.parametrize(
    ("given", "part"),
    [
        ({"kind": "spd"}, "there is psd, amplitude"),
        ({"window": "hamming"}, "there is hann"),
        ({"kind": "frf"}, "input"),
        ({"segment": 1000}, "longer than the record"),
        ({"kind": "srs", "q": 0.0}, "quality factor"),
        ({"derivative": 3}, "derivative"),
    ],
)
def test_impossible_spectra_are_rejected(given, part):
    with pytest.raises(emmy.InputError, match=part):
        emmy.spectrum(TIME, X, **given)


@pytest.mark.parametrize(
    ("given", "part"),
    [
        ({"frequencies": [0.0]}, "frequencies"),
        ({"base": "w"}, "neither x, y nor z"),
        ({"damping": -0.1, "base": "x"}, "damping ratio is -0.1"),
        ({"loads": [1]}, "no load with the number 1"),
        ({"nodes": [2]}, "nodes"),
        ({"quantity": "speed"}, "there is displacement"),
        ({"quantity": "cauchy_stress", "base": "x"}, "the body has no cauchy_stress"),
        ({"count": 2}, "2 modes"),
    ],
)
def test_impossible_responses_are_rejected(given, part):
    own = {"frequencies": [1.0], "count": 1, **given}
    with pytest.raises(emmy.InputError, match=part):
        emmy.response(oscillator(), own.pop("frequencies"), **own)
