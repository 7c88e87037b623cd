"""Couplings, masses beside the mesh, loads that follow, and what decks have besides their meshes."""

import pickle

import emmy
import numpy as np
import pytest

DECK = """*NODE
1, 0, 0, 0
2, 1, 0, 0
3, 1, 1, 0
4, 0, 1, 0
5, 0, 0, 1
6, 1, 0, 1
7, 1, 1, 1
8, 0, 1, 1
9, 0.5, 0.5, 2
*ELEMENT, TYPE=C3D8, ELSET=BODY
1, 1, 2, 3, 4, 5, 6, 7, 8
*NSET, NSET=FLOOR
1, 2, 3, 4
*NSET, NSET=ROOF
5, 6, 7, 8
*RIGID BODY, NSET=ROOF, REF NODE=9
*ELEMENT, TYPE=MASS, ELSET=LUMP
2, 9
*MASS, ELSET=LUMP
3.
"""


def rubber():
    return emmy.Region(emmy.NeoHooke(lambda_=1000.0, mu=500.0), density=2.0)


def clamped(**parts):
    mesh = emmy.Mesh.box((2, 1, 1), (2, 1, 1))
    return emmy.Body(mesh, rubber(), emmy.Support("x-min", fix="xyz"), **parts)


def test_a_force_at_a_point_of_a_face():
    hook = emmy.Coupling("hook", group="x-max", point=(2, 0.75, 0.5), kind="distributing")
    body = clamped(couplings=hook, loads=emmy.Load("hook", force=(0, 0, -8)))
    assert body.couplings == (hook,)
    again = pickle.loads(pickle.dumps(body))
    assert again.couplings == (hook,)
    u = emmy.equilibrium(again).displacement
    # The bilinear mean of the four corners; the work of the force is twice the strain energy of small strains.
    points = body.mesh.points
    corners = [node for node, X in enumerate(points) if X[0] == 2]
    weights = np.array([(0.75 if points[node][1] else 0.25) * 0.5 for node in corners])
    np.testing.assert_allclose(u[-1], weights @ u[corners], atol=1e-15)
    assert -8 * u[-1, 2] == pytest.approx(2 * body.strain_energy(u[: len(u)]), rel=0.1)


def test_a_mass_beside_the_mesh_is_a_rigid_body():
    engine = emmy.Mass("x-max", 3.0, at=(2.5, 0.5, 1.0), inertia=(0.3, 0.4, 0.5), name="engine")
    other = emmy.Rigid("engine", group="x-max", mass=3.0, centre=(2.5, 0.5, 1.0), inertia=(0.3, 0.4, 0.5))
    frequencies = [emmy.modes(body, 4).frequencies for body in (clamped(masses=engine), clamped(rigid=other))]
    np.testing.assert_array_equal(*frequencies)
    light = emmy.Mass("x-max", 3.0, at=(2.0, 0.5, 0.5), coupling="distributing")
    assert clamped(masses=light).total_mass == pytest.approx(7.0)
    with pytest.raises(emmy.InputError, match="a distributing coupling has no rotation"):
        emmy.Mass("x-max", 3.0, at=(2.0, 0.5, 0.5), coupling="distributing", inertia=(1, 1, 1))


def test_a_thrust_turns_with_its_body():
    puck = emmy.Rigid("puck", mass=2.0, centre=(0, 0, 0), inertia=(0.1, 0.1, 0.18))
    body = emmy.Body(rigid=puck, loads=emmy.Load("puck", force=(3, 0, 0), follow=True))
    spin = emmy.Initial(group="puck", angular_velocity=(0, 0, 2))
    history = emmy.Motion(body, degree=3, steps=(1.0, 0.05), initial=spin).run()
    assert history["puck_x"][-1] == pytest.approx(3 / 8 * (1 - np.cos(2)), abs=1e-8)
    turned = emmy.Body(rigid=puck, loads=emmy.Load("puck", torque={"axis": (0, 0, 2), "value": 0.36}))
    assert emmy.Motion(turned, steps=(1.0, 0.1)).run()["puck_spin_z"][-1] == pytest.approx(2.0, abs=1e-12)


def test_a_file_with_couplings_is_read(tmp_path):
    body = emmy.load(emmy.new("engine-mount")).body
    assert body.masses[0].at == (20, 20, 80)
    file = tmp_path / "hook.toml"
    file.write_text(
        "mesh.box = { size = [2, 1, 1], cells = [2, 1, 1] }\n"
        "region = { density = 2, material.neo-hooke = { lambda = 1000, mu = 500 } }\n"
        "support = { group = 'x-min', fix = ['x', 'y', 'z'] }\n"
        "coupling = { name = 'hook', group = 'x-max', point = [2, 0.5, 0.5], kind = 'distributing' }\n"
        "load = { group = 'hook', force = [0, 0, -8] }\n"
        "time = { scheme = 'DGM', steps = [{ until = 0.1, size = 0.1 }] }\n"
    )
    problem = emmy.load(file)
    assert problem.body.couplings[0].kind == "distributing"
    assert problem.body.mesh.n_nodes == 12


@pytest.mark.filterwarnings("ignore::emmy.EmmyWarning")
def test_decks_have_what_they_say(tmp_path):
    path = tmp_path / "deck.inp"
    path.write_text(DECK)
    mesh = emmy.Mesh.read(path)
    assert len(mesh.entries) == 2
    held = emmy.Support("FLOOR", fix="xyz")
    frequencies = emmy.modes(emmy.Body(mesh, rubber(), held), 3).frequencies
    same = emmy.Mass("nodes:ROOF", 3.0, at=(0.5, 0.5, 2.0))
    bare = emmy.Mesh.read(path, leave_out=list(mesh.entries))
    assert bare.entries == {}
    np.testing.assert_allclose(
        emmy.modes(emmy.Body(bare, rubber(), held, masses=same), 3).frequencies, frequencies, rtol=1e-10
    )
    assert sum(" acts: " in note for note in mesh.notes) == 2 and not any(" acts: " in note for note in bare.notes)
    # An entry goes with the one that it names.
    coupling = next(name for name, table in mesh.entries.items() if table["section"] == "coupling")
    alone = emmy.Mesh.read(path, leave_out=[coupling])
    assert alone.entries == {}
    assert [note for note in alone.notes if " is left out with " in note] == [
        f"{name} is left out with {coupling}" for name in mesh.entries if name != coupling
    ]
    copy = pickle.loads(pickle.dumps(mesh))
    assert copy.entries == mesh.entries
    assert emmy.modes(emmy.Body(copy, rubber(), held), 3).frequencies == pytest.approx(frequencies)
    # Lengths twice as long, the mass as it stands.
    place = next(table["point"] for table in mesh.scaled(2.0).entries.values() if "point" in table)
    assert tuple(place) == (1.0, 1.0, 4.0)
    with pytest.raises(emmy.InputError, match="nothing that is named 'rigid'"):
        emmy.Mesh.read(path, leave_out=["rigid"])
