"""Every mistake has its exception; `test_messages` has the messages in full."""

import pickle

import emmy
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from bodies import free_block, rubber

TET = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], dtype=float)


def test_unknown_groups_all_at_once():
    mesh = emmy.Mesh.box((1, 1, 1), (1, 1, 1))
    loads = [emmy.Load("x-max", force=(1, 0, 0)), emmy.Load("x-mxa", force=(1, 0, 0))]
    with pytest.raises(emmy.UnknownGroupError) as raised:
        emmy.Body(mesh, emmy.Region(rubber(), density=1.0), emmy.Support("foot", fix="xyz"), loads)
    faults = {fault.place: fault for fault in raised.value.faults}
    assert set(faults) == {"supports[0].group", "loads[1].group"}
    assert faults["supports[0].group"].group == "foot" and "x-min" in raised.value.available
    assert "the mesh has no group `x-mxa` of facets; did you mean `x-max`?" in str(raised.value)
    with pytest.raises(emmy.UnknownGroupError, match="the mesh has no group `x-mxa`; did you mean `x-max`"):
        mesh.group_nodes("x-mxa")


@pytest.mark.parametrize(
    ("make", "place"),
    [
        (lambda: emmy.NeoHooke(youngs_modulus=1.0, poissons_ratio=0.5), "poissons_ratio"),
        (lambda: emmy.NeoHooke(lambda_=float("nan"), mu=1.0), "lambda_"),
        (lambda: emmy.Region(rubber(), density=-1.0), "density"),
        (lambda: emmy.Region(rubber(), density=float("nan")), "density"),
        (lambda: emmy.Region(rubber(), density=1.0, formulation="mixed"), "formulation"),
        (lambda: emmy.Support("foot", fix="xyw"), "fix"),
        (lambda: emmy.Mass("star", 0.0), "mass"),
        (lambda: emmy.Tie("upper", "lower", kind="mortr"), "kind"),
        (lambda: emmy.Tie("upper", "lower", tolerance=-1.0), "tolerance"),
        (lambda: emmy.Tie("upper", "upper"), "leader"),
        (lambda: emmy.Contact("all", emmy.Plane((0, 0, 0), (0, 0, 1)), stiffness=-1.0), "stiffness"),
        (lambda: emmy.Plane((0, 0), (0, 0, 1)), "point"),
        (lambda: emmy.Sphere((0, 0, 0), 0.0), "radius"),
        (lambda: emmy.Rigid("hub", mass=0.0, centre=(0, 0, 0)), "mass"),
        (lambda: emmy.Joint.fixed(between=("a", "b"), at=(0, 0)), "at"),
        (lambda: emmy.Initial(velocity=(1, 2)), "velocity"),
        (lambda: emmy.Viscosity(time=-1.0), "time"),
        (lambda: emmy.Load("tip", force=(1, 2)), "force"),
        (lambda: emmy.Load("tip", force=(1, 2, 3), history=[(1.0, 0.0), (0.0, 1.0)]), "history"),
        (lambda: emmy.Load("tip", force=(1, 2, 3), history="sin(2*pi*x)"), "history"),
        (lambda: emmy.Motion(free_block(), steps=(1.0, 2.0, 3.0)), "steps"),
        (lambda: emmy.Motion(free_block(), steps=(1.0, 0.0)), "steps"),
        (lambda: emmy.Motion(free_block(), steps=[(1.0, 0.1), (0.5, 0.1)]), "steps"),
        (lambda: emmy.Motion(free_block(), until=1.0), "until"),
        (lambda: emmy.Motion(free_block(), steps=(1.0, 0.1), degree=99), "degree"),
        (lambda: emmy.Motion(free_block(), steps=(1.0, 0.1), tolerance=2.0), "tolerance"),
        (lambda: emmy.Motion(free_block(), steps=(1.0, 0.1), solver="lu"), "solver"),
        (lambda: emmy.Motion(free_block(), steps=(1.0, 0.1), probes={"tip": (1, 2)}), "probes"),
        (lambda: emmy.Mesh(TET[:, :2], {"tet4": [[0, 1, 2, 3]]}), "points"),
        (lambda: emmy.Mesh(TET, {"tet4": [0, 1, 2, 3]}), "cells.tet4"),
        (lambda: emmy.Mesh(TET, {"tet4": [[0, 1, 2, -1]]}), "cells.tet4[0]"),
        (lambda: emmy.Mesh(TET, {"tet4": np.array([[0, 1, 2, 2**63]], dtype=np.uint64)}), "cells.tet4[0]"),
        (lambda: rubber().energy(np.zeros((3, 2))), "strain"),
    ],
)  # fmt: skip
def test_values_out_of_range(make, place):
    with pytest.raises(emmy.InputError) as raised:
        make()
    own = raised.value.faults[0].place
    assert own == place or own.startswith((place + "[", place + ".")), raised.value
    assert isinstance(raised.value, ValueError)


def test_a_tolerance_out_of_range():
    with pytest.raises(emmy.InputError, match="`tolerance` must be between 0 and 1, not 2"):
        emmy.Adaptive(2.0)


@pytest.mark.parametrize(
    "make",
    [
        lambda: emmy.Mesh(TET, {"tet4": [[0.0, 1.0, 2.0, 3.0]]}),
        lambda: emmy.Mesh(TET.astype(object), {"tet4": [[0, 1, 2, 3]]}),
        lambda: emmy.Mesh(TET, {"tet4": np.array([[0, 1, 2, None]])}),
        lambda: emmy.Load("tip", force=np.array(["a", "b", "c"])),
        lambda: emmy.Load("tip", force=lambda points, t: points),
        lambda: emmy.Support("foot", move={"x": lambda t: t}),
        lambda: emmy.Load("tip", force=(1, 2, 3), history=1 + 2j),
    ],
)
def test_wrong_types(make):
    with pytest.raises(TypeError):
        make()


def test_a_motion_without_a_plan():
    motion = emmy.Motion(free_block(), initial=emmy.Initial(velocity=(1, 0, 0)))
    message = "the motion has no plan; give steps=... or until=... with adaptive=..., or use motion.step"
    for use in (lambda: next(iter(motion)), motion.run, lambda: next(motion)):
        with pytest.raises(RuntimeError, match=message):
            use()
    assert motion.step(0.1).number == 1


def test_a_step_that_cannot_be_done():
    from bodies import spinning_block

    motion = spinning_block(max_iterations=1, smallest_step=0.05)
    with pytest.raises(emmy.ConvergenceError) as raised:
        motion.run()
    assert raised.value.step == 1 and motion.number == 0
    assert "try" in str(raised.value)
    again = pickle.loads(pickle.dumps(raised.value))
    assert str(again) == str(raised.value) and again.step == 1


def test_a_limit():
    from bodies import spinning_block

    motion = spinning_block(scheme="FE(1)", limits={"energy": 1e-15})
    with pytest.raises(emmy.LimitExceeded):
        motion.run()
    assert motion.number >= 1


def test_errors_can_be_pickled():
    with pytest.raises(emmy.InputError) as raised:
        emmy.Region(rubber(), density=-1.0)
    again = pickle.loads(pickle.dumps(raised.value))
    assert str(again) == str(raised.value) and again.faults == raised.value.faults


VALUES = st.one_of(
    st.none(), st.booleans(), st.integers(), st.floats(), st.text(max_size=5), st.binary(max_size=3),
    st.lists(st.floats(), max_size=4), st.lists(st.lists(st.integers(), max_size=4), max_size=3),
    st.dictionaries(st.text(max_size=3), st.floats(), max_size=2), st.complex_numbers(),
)  # fmt: skip


@settings(max_examples=300, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.data())
def test_random_values_end_in_an_input_error_or_a_type_error(data):
    def some(*names):
        return data.draw(st.dictionaries(st.sampled_from(names), VALUES, max_size=3))

    kinds = (
        "traction",
        "force",
        "pressure",
        "nodal_force",
        "acceleration",
        "body_force",
        "attraction",
        "drag",
        "history",
    )
    try:
        mesh = emmy.Mesh.box((1, 1, 1), (1, 1, 1))
        region = emmy.Region(
            emmy.Yeoh(**{"c10": 1.0, "c20": 0.0, "c30": 0.0, "bulk_modulus": 10.0} | some("c10", "c20")), density=1.0
        )
        supports = emmy.Support("x-min", **{"fix": "x"} | some("fix", "move", "rotate", "spring", "until", "symmetry"))
        load = emmy.Load("x-max", **some(*kinds))
        body = emmy.Body(mesh, region, supports, load)
        emmy.Motion(body, **{"steps": (0.1, 0.1)} | some("steps", "degree", "adaptive", "probes", "limits", "solver"))
    except (emmy.InputError, TypeError, emmy.EmmyWarning):
        pass


@settings(max_examples=200, deadline=None)
@given(
    st.lists(st.tuples(*[st.floats(width=32)] * 3), max_size=6),
    st.sampled_from(["tet4", "tri3", "line2", "hex8", "cube"]),
    st.lists(st.lists(st.integers(-2, 8), min_size=2, max_size=4), max_size=3),
)
def test_random_meshes_end_in_a_mesh_or_an_input_error(points, kind, cells):
    try:
        emmy.Mesh(np.array(points, dtype=float).reshape(-1, 3), {kind: cells})
    except (emmy.InputError, TypeError, emmy.EmmyWarning):
        pass
