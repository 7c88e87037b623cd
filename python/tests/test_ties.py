"""Parts with different meshes, joined by ties."""

import pickle
from contextlib import nullcontext

import emmy
import numpy as np
import pytest


def block(n, bottom, first):
    """Points and cells of a block 2 x 2 x 1 with n x n x 2 cells, and its lower and upper faces."""
    z, y, x = np.meshgrid(bottom + np.linspace(0, 1, 3), *2 * [np.linspace(0, 2, n + 1)], indexing="ij")
    number = first + np.arange(x.size).reshape(x.shape)
    around = [(0, 0), (0, 1), (1, 1), (1, 0)]                      # y and x of the corners of a face
    face = [number[:, j : n + j, i : n + i] for j, i in around]
    layers = [np.stack([corner[k].ravel() for corner in face], axis=1) for k in range(3)]
    cells = np.concatenate([np.hstack(layers[k : k + 2]) for k in range(2)])
    return np.stack([x.ravel(), y.ravel(), z.ravel()], axis=1), cells, layers[0], layers[-1]


def tied_blocks(gap=0.0, **tie):
    lower, upper = block(2, 0.0, 0), block(3, 1.0 + gap, 27)
    with pytest.warns(emmy.EmmyWarning, match="not joined there") if gap == 0.0 else nullcontext():
        mesh = emmy.Mesh(
            np.concatenate([lower[0], upper[0]]),
            {"hex8": np.concatenate([lower[1], upper[1]])},
            facet_groups={"lower-face": lower[3], "upper-face": upper[2]},
        )
    return emmy.Body(
        mesh,
        emmy.Region(emmy.NeoHooke(lambda_=4000.0, mu=2000.0), density=1.0),
        ties=emmy.Tie("upper-face", "lower-face", **tie),
    )


def test_blocks_in_free_flight():
    body = tied_blocks()
    assert repr(body) == "<emmy.Body: 26 cells, 225 degrees of freedom, 0 fixed, 48 tied>"
    assert body.total_mass == pytest.approx(8.0, rel=1e-14)
    assert "tie        16 nodes of upper-face follow lower-face by mortar\n" in str(body) and body.notes == []
    stretch = np.diag([0.05, -0.03, 0.02])
    start = emmy.Initial(
        velocity=-stretch.sum(axis=1), angular_velocity=(0.5, 0.3, 1.0), about=(1, 1, 1), gradient=stretch
    )
    motion = emmy.Motion(body, "DGM", steps=(1.0, 0.05), initial=start, tolerance=1e-13)
    history = motion.run()
    # Results of an independent implementation.
    assert history["strain_energy"][-1] == pytest.approx(0.005241116208426446, rel=1e-9)
    assert history["kinetic_energy"][-1] == pytest.approx(3.573158883791574, rel=1e-9)
    top = body.mesh.nearest_node((2, 2, 2))
    place = body.mesh.points[top] + motion.displacement[top]
    np.testing.assert_allclose(place, [1.249490358226591, 2.038651597294709, 2.363306591223248], rtol=1e-9)


def test_nodes_follow_points_of_facets():
    body = tied_blocks(kind="nodes")
    start = emmy.Initial(velocity=(0, 0, 1), gradient=np.diag([0.05, -0.03, 0.02]))
    motion = emmy.Motion(body, steps=(0.2, 0.05), initial=start)
    motion.run()
    # A follower in the middle of an edge between two leaders, at a third of it.
    follower, leaders = (body.mesh.group_nodes(name) for name in ("upper-face", "lower-face"))
    at = {tuple(body.mesh.points[node].round(9)): motion.displacement[node] for node in leaders}
    own = motion.displacement[follower[1]]
    np.testing.assert_allclose(own, (at[0.0, 0.0, 1.0] + 2 * at[1.0, 0.0, 1.0]) / 3, atol=1e-14)


def test_shifts_are_noted_or_too_large():
    note = "tie of `upper-face` to `lower-face`: nodes are moved by up to 0.03"
    with pytest.warns(emmy.EmmyWarning, match=note):
        body = tied_blocks(gap=0.03)
    # The lower face of the upper block comes down by the gap.
    assert body.total_mass == pytest.approx(8.0 + 4 * 0.03, rel=1e-13)
    with pytest.raises(emmy.InputError, match="upper-face") as raised:
        tied_blocks(gap=0.03, tolerance=0.01)
    assert raised.value.faults[0].place.startswith("ties[0]")


def test_a_body_with_ties_travels():
    body = tied_blocks()
    other = pickle.loads(pickle.dumps(body))
    assert other.ties == body.ties == (emmy.Tie("upper-face", "lower-face"),)
    assert '[[tie]]\nfollower = "upper-face"\nleader = "lower-face"\n' in body.to_toml()
    assert '\nkind = "nodes"' in tied_blocks(kind="nodes").to_toml()
    modes = emmy.modes(body, 9)
    assert modes.rigid == 6
    np.testing.assert_array_equal(emmy.modes(other, 9).frequencies, modes.frequencies)
