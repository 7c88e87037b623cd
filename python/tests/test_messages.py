"""The messages of mistakes, in full: the table of the errors of the package."""

import pickle
import sys
import traceback

import emmy
import numpy as np
import pytest

from bodies import free_block, rubber, spinning_block

TET = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], dtype=float)


def on_two_facets(**parts):
    facets = {"foot": [[0, 1, 2]], "tip": [[1, 2, 3]]}
    mesh = emmy.Mesh(TET, {"tet4": [[0, 1, 2, 3]]}, facet_groups=facets)
    return emmy.Body(mesh, emmy.Region(rubber(), density=1.0), **parts)


def with_history(history):
    mesh = emmy.Mesh.box((1, 1, 1), (1, 1, 1))
    load = emmy.Load("x-max", force=(1, 0, 0), history=history)
    return emmy.Motion(emmy.Body(mesh, emmy.Region(rubber(), density=1.0), loads=load), steps=(0.375, 0.125))


def late(value):
    def push(t):
        if t > 0.125 and isinstance(value, type):
            raise value("mine")
        return 1.0 if t <= 0.125 else value

    push.__qualname__ = "push"
    return push


def driven_by(rate):
    def path(t):
        return 0.0

    def rate_of_path(t):
        return 0.0 if t == 0 else rate

    path.__qualname__ = "path"
    support = emmy.Support("x-min", move={"x": (path, rate_of_path)})
    body = emmy.Body(emmy.Mesh.box((1, 1, 1), (1, 1, 1)), emmy.Region(rubber(), density=1.0), support)
    return emmy.Motion(body, steps=(1.0, 0.5))


def pulled_by(late):
    def pull(points, t):
        return np.zeros((len(points), 3)) if t == 0 else late

    pull.__qualname__ = "pull"
    load = emmy.Load("x-max", traction=pull)
    body = emmy.Body(emmy.Mesh.box((1, 1, 1), (1, 1, 1)), emmy.Region(rubber(), density=1.0), loads=load)
    return emmy.Motion(body, steps=(0.5, 0.25))


def driven():
    support = emmy.Support("x-min", move={"x": "t"})
    return emmy.Body(emmy.Mesh.box((1, 1, 1), (1, 1, 1)), emmy.Region(rubber(), density=1.0), support)


def small_block():
    return emmy.Motion(emmy.Body(emmy.Mesh.box((1, 1, 1), (1, 1, 1)), emmy.Region(rubber(), density=1.0)))


def goal(motion):
    return emmy.Goal.displacement_at(motion.body, node=0, direction=(1, 0, 0))


def gradient(motion):
    return motion.gradient(goal(motion))


def goal_error(motion):
    return motion.goal_error(goal(motion))


KINDS = (
    "exactly one of `traction`, `force`, `nodal_force`, `moment`, `torque`, `pressure`, `acceleration`, `gravity`, "
    "`body_force`, `attraction`, `rotation`, `drag`"
)
NO_PLAN = "the motion has no plan; give steps=... or until=... with adaptive=..., or use motion.step(size)"

MESSAGES = [
    (
        lambda: emmy.Motion(free_block(), scheme="dg", steps=(1.0, 0.1)),
        emmy.InputError,
        'scheme: "dg": not a scheme; there is FE(n), AS(n), DGM, trapezoidal, Lobatto(n), n a number of points'
        ", AS(n, rho) and DGM(rho) that dissipate, and Newmark, HHT, generalized-alpha, Bathe, central-differences; "
        'did you mean "DGM"?',
    ),
    (
        lambda: on_two_facets(supports=emmy.Support("foto", fix="x"), loads=emmy.Load("tipp", force=(1, 0, 0))),
        emmy.UnknownGroupError,
        "loads[0].group: the mesh has no group `tipp` of facets; did you mean `tip`?\n"
        "supports[0].group: the mesh has no group `foto` of nodes, facets or cells; did you mean `foot`?",
    ),
    (lambda: emmy.Load("tip"), emmy.InputError, f"[[load]] needs {KINDS}"),
    (
        lambda: emmy.Load("tip", force=(1, 0, 0), pressure=1.0),
        emmy.InputError,
        f"force: [[load]] takes {KINDS}",
    ),
    (
        lambda: emmy.NeoHooke(E=210e3),
        TypeError,
        "NeoHooke has no argument E; it has: lambda_, mu, youngs_modulus, poissons_ratio, bulk_modulus",
    ),
    (
        lambda: emmy.NeoHooke(youngs_modulus=1.0, poissons_ratio=0.5),
        emmy.InputError,
        "poissons_ratio: `poissons_ratio` must be between -1 and 0.5, both excluded, not 0.5",
    ),
    (
        lambda: emmy.Region(rubber(), density=-1),
        emmy.InputError,
        "density: `density` must be positive, not -1",
    ),
    (
        lambda: emmy.NeoHooke(lambda_=float("nan"), mu=1.0),
        emmy.InputError,
        "lambda_: `lambda` must be a finite number, not NaN",
    ),
    (
        lambda: emmy.Region(rubber(), density=float("nan")),
        emmy.InputError,
        "density: `density` must be a finite number, not NaN",
    ),
    (
        lambda: emmy.NeoHooke(lambda_=1.0),
        emmy.InputError,
        "lambda_: `neo-hooke` needs exactly two elastic constants, not 1; the pairs: `lambda` with `mu`, "
        "`youngs_modulus`, `poissons_ratio` or `bulk_modulus`; `mu` with `youngs_modulus`, `poissons_ratio` or "
        "`bulk_modulus`; `youngs_modulus` with `poissons_ratio` or `bulk_modulus`; `poissons_ratio` with `bulk_modulus`",
    ),
    (
        lambda: emmy.NeoHooke(lambda_="1", mu=1.0),
        emmy.InputError,
        "lambda_: `lambda` must be a number, not a string; numbers stand without quotes",
    ),
    (
        lambda: emmy.Region(rubber(), densty=1.0),
        TypeError,
        "Region has no argument densty; it has: material, density, group, thickness, viscosity, formulation, pressure; "
        "did you mean density?",
    ),
    (
        lambda: emmy.Region("steel", density=1.0),
        TypeError,
        "material: str is not a material, such as emmy.NeoHooke",
    ),
    (
        lambda: emmy.Body("bracket.msh", emmy.Region(rubber(), density=1.0)),
        TypeError,
        "mesh: str is not an emmy.Mesh; see Mesh.read and Mesh.from_meshio",
    ),
    (
        lambda: emmy.Body(emmy.Mesh.box((1, 1, 1), (1, 1, 1)), [rubber()]),
        TypeError,
        "regions[0]: emmy.NeoHooke in place of emmy.Region",
    ),
    (
        lambda: emmy.Body(emmy.Mesh.box((1, 1, 1), (1, 1, 1)), rubber()),
        TypeError,
        "regions: emmy.NeoHooke in place of emmy.Region or a list of them",
    ),
    (
        lambda: emmy.Mesh(TET, cells=[[0, 1, 2, 3]]),
        TypeError,
        "cells: list in place of a dict",
    ),
    (
        lambda: spinning_block().run(observers=5),
        TypeError,
        "observers: int in place of a function or a list of functions",
    ),
    (
        lambda: emmy.Mesh.box((1, 1, 1), (1, 1, 1)).group_nodes("x-mn"),
        emmy.UnknownGroupError,
        "name: the mesh has no group `x-mn`; did you mean `x-min`?",
    ),
    (
        lambda: emmy.Mesh(TET, {"tet4": [0, 1, 2, 3]}),
        emmy.InputError,
        "cells.tet4: expected an array of shape (n, nodes), found (4,)",
    ),
    (
        lambda: emmy.Mesh(TET, {"tet4": [[0, 1, 2, 3], [0, 1]]}),
        emmy.InputError,
        "cells.tet4: its rows have different lengths",
    ),
    (lambda: emmy.Mesh(TET, {"tet4": [[0, 1, 2]]}), emmy.MeshError, "mesh: a tet4 cell has 4 nodes, not 3"),
    (
        lambda: emmy.Mesh(TET, {"tet5": [[0, 1, 2, 3]]}),
        emmy.MeshError,
        'cells: "tet5" is not a kind of cell; there is hex8, hex20, hex27, tet4, tet10, wedge6, wedge15, pyramid5, '
        "pyramid13, tri3, tri6, quad4, quad8, quad9, line2",
    ),
    (
        lambda: emmy.Mesh(TET, {"tet4": [[0, 1, 2, 3]]}, cell_groups={"all": [1]}),
        emmy.MeshError,
        "cell_groups.all: there is no cell 1 among 1, counted from 0",
    ),
    (
        lambda: emmy.Mesh(TET, {"tet4": [[0, 1, 2, 3]]}, facet_groups={"tip": [[0, 7]]}),
        emmy.MeshError,
        "facet_groups.tip: a row must be the number of a cell and of one of its faces, counted from 0",
    ),
    (
        lambda: emmy.Mesh(TET, {"tet4": [[0, 1, 2, 3]]}, node_groups={"tip": [4]}),
        emmy.MeshError,
        "node_groups.tip: there is no node 4 among 4, counted from 0",
    ),
    (
        lambda: emmy.Mesh.from_pyvista("grid.vtu"),
        TypeError,
        "grid: str is not a data set of PyVista; Mesh.read reads files",
    ),
    (
        lambda: emmy.Mesh.from_meshio("mesh.msh"),
        TypeError,
        "mesh: str is not a meshio.Mesh; Mesh.read reads files",
    ),
    (lambda: emmy.Mesh.from_meshio(None), TypeError, "mesh: NoneType is not a meshio.Mesh"),
    (
        lambda: emmy.Mesh.network(TET, [0, 1]),
        emmy.InputError,
        "links: expected an array of shape (m, 2), found (2,)",
    ),
    (
        lambda: emmy.Mesh(TET * np.nan, {"tet4": [[0, 1, 2, 3]]}),
        emmy.MeshError,
        "mesh: node 0 has a coordinate that is not a finite number",
    ),
    (
        lambda: emmy.Mesh(TET[:, :2], {"tet4": [[0, 1, 2, 3]]}),
        emmy.InputError,
        "points: expected an array of shape (n, 3), found (4, 2)",
    ),
    (
        lambda: emmy.Mesh(TET, {"tet4": [[0, 1, 2, 2**40]]}),
        emmy.InputError,
        "cells.tet4[0]: 1099511627776 is not the number of a node or cell",
    ),
    (
        lambda: emmy.Mesh(TET, {"tet4": [[0, 1, 2, -1]]}),
        emmy.InputError,
        "cells.tet4[0]: -1 is not the number of a node or cell",
    ),
    (
        lambda: emmy.Mesh(TET, {"tet4": [[0, 1, 2, 4]]}),
        emmy.InputError,
        "cells.tet4[0]: there is no node 4 among 4 points",
    ),
    (
        lambda: emmy.Mesh(TET, {"tet4": np.array([[0.0, 1.0, 2.0, 3.0]])}),
        TypeError,
        "cells.tet4: an array of float64 in place of whole numbers",
    ),
    (
        lambda: emmy.Mesh(TET.astype(object), {"tet4": [[0, 1, 2, 3]]}),
        TypeError,
        "points: an array of object in place of numbers",
    ),
    (
        lambda: emmy.Mesh(TET, {"tet4": [[0, 2, 1, 3], [0, 2, 3, 3]]}),
        emmy.MeshError,
        "mesh: the arrays: cell 1 (tet4) is inverted or degenerate: det(dX/dxi) = 0 at one of its points, and the "
        "mirrored order of its nodes does not help; check its shape in the mesher",
    ),
    (
        lambda: emmy.Motion(free_block(), steps=(1.0, 2.0, 3.0)),
        emmy.InputError,
        "steps: expected a pair (until, size), or a list of pairs, found (1.0, 2.0, 3.0)",
    ),
    (
        lambda: emmy.Motion(free_block(), steps=(1.0, 0.0)),
        emmy.InputError,
        "steps[0]: `size` must be positive, not 0",
    ),
    (
        lambda: emmy.Motion(free_block(), steps=[(1.0, 0.1), (0.5, 0.1)]),
        emmy.InputError,
        "steps[1]: phase 2 of `steps`: it ends at 0.5, but begins at 1; `until` must increase",
    ),
    (
        lambda: emmy.Motion(free_block(), adaptive=1e-3),
        emmy.InputError,
        "until: adaptive steps need the end of the motion",
    ),
    (
        lambda: emmy.Motion(free_block(), until=1.0),
        emmy.InputError,
        "until: the steps to this time are missing; give steps=(until, size), or adaptive=1e-4 beside until",
    ),
    (
        lambda: emmy.Motion(free_block(), steps=(float("nan"), 0.1)),
        emmy.InputError,
        "steps[0]: `until` must be a finite number, not NaN",
    ),
    (
        lambda: emmy.Motion(free_block()).step(0.0),
        emmy.InputError,
        "size: must be positive and finite, not 0",
    ),
    (lambda: list(emmy.Motion(free_block())), RuntimeError, NO_PLAN),
    (lambda: next(emmy.Motion(free_block())), RuntimeError, NO_PLAN),
    (lambda: emmy.Motion(free_block()).run(), RuntimeError, NO_PLAN),
    (
        lambda: with_history(lambda t: None),
        TypeError,
        "loads[0].history: <lambda>.<locals>.<lambda> returned NoneType in place of a number",
    ),
    (
        lambda: with_history(lambda t: np.ones(2)),
        TypeError,
        "loads[0].history: <lambda>.<locals>.<lambda> returned ndarray in place of a number",
    ),
    (
        lambda: with_history(late(None)).run(),
        TypeError,
        "loads[0].history: push returned NoneType in place of a number",
    ),
    (
        lambda: with_history(late(np.ones(2))).run(),
        TypeError,
        "loads[0].history: push returned ndarray in place of a number",
    ),
    (
        lambda: with_history(late(np.True_)).run(),
        TypeError,
        "loads[0].history: push returned bool in place of a number",
    ),
    (lambda: with_history(late(ValueError)).run(), ValueError, "mine"),
    (
        lambda: emmy.Support("foot", move={"x": np.sin}),
        TypeError,
        "move.x: a function comes with its rate, as a pair (function, rate): the method needs the velocity",
    ),
    (
        lambda: driven_by(None).run(),
        TypeError,
        "supports[0].move.x: the rate of path returned NoneType in place of a number",
    ),
    (
        lambda: driven_by(float("nan")).run(),
        emmy.ConvergenceError,
        "supports[0].move.x: the rate of path returned NaN at t = 0.5",
    ),
    (
        lambda: pulled_by(np.zeros(3)).run(),
        TypeError,
        "loads[0].traction: pull returned an array of shape (3,) in place of an array of shape (4, 3)",
    ),
    (
        lambda: spinning_block(scheme="FE(1)", limits={"energy": 1e-15}).run(),
        emmy.LimitExceeded,
        "step 1, t = 0.05: the accumulated energy residual is 1.469e-2 of the largest T + V; the limit is 1e-15",
    ),
    (
        lambda: pickle.dumps(spinning_block()),
        TypeError,
        "a Motion cannot be pickled; pickle motion.snapshot() and the body",
    ),
    (
        lambda: gradient(spinning_block()),
        RuntimeError,
        "the motion keeps no trajectory; make it with adjoint=True",
    ),
    (lambda: gradient(spinning_block(adjoint=True)), RuntimeError, "the motion has not done a step yet"),
    (
        lambda: goal_error(spinning_block()),
        RuntimeError,
        "the motion keeps no trajectory; make it with adjoint=True",
    ),
    (lambda: spinning_block(adjoint=True).gradient(5), TypeError, "goal: int in place of emmy.Goal"),
    (lambda: emmy.modes(free_block(), state=5), TypeError, "state: int in place of emmy.State"),
    (
        lambda: goal(small_block()).value(spinning_block()),
        emmy.InputError,
        "goal: it belongs to a body with another number of nodes",
    ),
    (
        lambda: emmy.Motion(driven(), steps=(1.0, 0.5), adjoint=True),
        emmy.InputError,
        "adjoint: driven supports are not covered; supports at rest are",
    ),
]


@pytest.mark.parametrize(("mistake", "kind", "message"), MESSAGES)
def test_message(mistake, kind, message):
    with pytest.raises(kind) as raised:
        mistake()
    assert type(raised.value) is kind
    assert str(raised.value) == message


def test_what_a_function_raises_has_a_note():
    with pytest.raises(KeyError) as raised:
        with_history(late(KeyError)).run()
    (note,) = raised.value.__notes__
    assert note.startswith("in loads[0].history (push) at t = 0.1")
    with pytest.raises(ZeroDivisionError) as raised:
        with_history(lambda t: 1 / t)
    (note,) = raised.value.__notes__
    assert note.startswith("in loads[0].history (") and note.endswith("<lambda>) at t = 0")


def test_a_function_that_is_not_finite():
    with pytest.raises(emmy.ConvergenceError) as raised:
        with_history(late(float("nan"))).run()
    assert str(raised.value) == f"loads[0].history: push returned NaN at t = {raised.value.time!r}"
    assert 0.125 < raised.value.time <= 0.25


def test_a_step_that_cannot_be_done():
    motion = spinning_block(max_iterations=1, smallest_step=0.05)
    with pytest.raises(emmy.ConvergenceError) as raised:
        motion.run()
    assert str(raised.value) == (
        "no convergence in step 1, to t = 0.05: residual 4.061e-2 after 1 iteration (wanted 1.030e-11), largest at "
        "node 7 near [0, 1, 1]; try a smaller step, or more iterations"
    )
    assert (raised.value.step, raised.value.time, motion.number, motion.time) == (1, 0.05, 0, 0.0)


@pytest.mark.parametrize(
    ("package", "use", "message"),
    [
        ("pyvista", lambda motion: motion.to_pyvista(), "to_pyvista needs PyVista: pip install emmy-fem[pyvista]"),
        ("meshio", lambda motion: motion.body.mesh.to_meshio(), "to_meshio needs meshio: pip install emmy-fem[meshio]"),
        ("scipy", lambda motion: motion.body.mass(), "a sparse matrix needs SciPy: pip install scipy"),
        ("gmsh", lambda motion: emmy.Mesh.from_gmsh(), "from_gmsh needs Gmsh: pip install gmsh"),
        ("matplotlib", lambda motion: emmy.plot.energies(motion), "emmy.plot needs Matplotlib: pip install matplotlib"),
        ("pandas", lambda motion: motion.history.to_pandas(), "to_pandas needs pandas: pip install pandas"),
    ],
)
def test_a_package_that_is_missing(package, use, message, monkeypatch):
    motion = spinning_block()
    for name in [name for name in sys.modules if name.partition(".")[0] == package]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(ImportError) as raised:
        use(motion)
    assert str(raised.value) == message


def test_tracebacks_name_public_classes():
    for error in (emmy.InputError([emmy.Fault("degree", "must be at least 1")]), emmy.ResultsError("no run")):
        assert traceback.format_exception_only(error)[0].startswith(f"emmy.{type(error).__name__}: ")
        assert type(pickle.loads(pickle.dumps(error))) is type(error)
    assert repr(emmy.Step) == "<class 'emmy.Step'>"


def block():
    return emmy.new("spinning-block")


#: Flags of the command line are arguments here.
FLAGS = [
    (
        lambda: spinning_block().run(output=block()),
        emmy.ResultsError,
        "spinning-block.toml is not a directory; name another one with output=",
    ),
    (lambda: spinning_block().run(output=""), emmy.InputError, "output: `directory` must not be empty"),
    (
        lambda: emmy.converge(block(), sizes=[0.4, 0.4]),
        emmy.InputError,
        "sizes: 0.4: the size is given twice",
    ),
    (
        lambda: emmy.converge(block(), sizes=[-1]),
        emmy.InputError,
        "sizes: -1: a step size must be positive and finite; such as sizes=[0.04,0.02,0.01]",
    ),
    (
        lambda: emmy.converge(block(), sizes=[0.4, 0.2], window=(1, 0)),
        emmy.InputError,
        "window: 1,0: the runs go from t = 0 to t = 20; it must be two of their times, the earlier one first",
    ),
    (
        lambda: emmy.converge(block(), sizes=[0.4, 0.2], start=30),
        emmy.InputError,
        "start: 30: ",
    ),
    (
        lambda: emmy.converge(block(), sizes=[0.4, 0.2], reference=0.5),
        emmy.InputError,
        "reference: 0.5: it must be positive and smaller than the smallest of sizes= (0.2); or give the reference a "
        "higher degree with reference_degree=",
    ),
    (
        lambda: emmy.load(block(), set={"region.9.density": 1}),
        emmy.InputError,
        "set: `9` is not the number of an item; the list has 1, counted from 0",
    ),
    (
        lambda: emmy.run(block(), set={"region.0.density": [1]}),
        emmy.InputError,
        "set: `density` must be a number, not a list",
    ),
    (
        lambda: emmy.sweep(block(), {"region.0.density": [-1]}),
        emmy.InputError,
        "parameters: ",
    ),
    (lambda: emmy.sweep(block(), {"x": [None]}), TypeError, "parameters.x[0]: NoneType has no place in an input"),
    (lambda: emmy.run(block(), threads=0), emmy.InputError, "threads: invalid value '0': 0 is not in 1..=65535"),
    (
        lambda: emmy.run(block(), until=-1),
        emmy.InputError,
        "until: -1: it ends at -1, but begins at 0; `until` must increase",
    ),
    (
        lambda: emmy.resume(emmy.run(block(), until=0.1, set={"output.every": 0}, output="o").directory, until=0.1),
        emmy.InputError,
        "the run has already reached t = 0.1 (step 1); its plan ends at t = 0.1; give a later end with until=T; `emmy "
        "report o` writes the report again",
    ),
]


@pytest.mark.parametrize(("mistake", "kind", "message"), FLAGS)
def test_flags_are_arguments(mistake, kind, message):
    with pytest.raises(kind) as raised:
        mistake()
    assert str(raised.value) == message or (message.endswith(": ") and str(raised.value).startswith(message))
    assert "--" not in str(raised.value)
    assert str(pickle.loads(pickle.dumps(raised.value))) == str(raised.value)
    if kind is emmy.InputError and not message.startswith("the run has"):
        assert [own.place for own in raised.value.faults] == [message.partition(":")[0]]


@pytest.mark.parametrize(
    ("text", "call"),
    [
        ("such as --window 1,2", "such as window=[1,2]"),
        ("remove `steps` with `--set time.steps=`", 'remove `steps` with `set={"time.steps": None}`'),
        ("--set load.0.history.file=PATH", 'set={"load.0.history.file": PATH}'),
        ("an empty text is --set 'title=\"\"'", 'an empty text is set={"title": ""}'),
        ("leave --resume out to start a sweep", "leave resume=True out to start a sweep"),
        ("such as --reference-scheme DGM", "such as reference_scheme=DGM"),
        ("a smaller --reference", "a smaller reference="),
        ("--from 3", "start=3"),
        ("cannot read a--set.toml and ---to", "cannot read a--set.toml and ---to"),
        ("`emmy list schemes` explains them", "`emmy.schemes()` explains them"),
    ],
)
def test_flags_in_texts(text, call):
    error = emmy.ConvergenceError(text)
    assert str(error) == error.message == call and str(pickle.loads(pickle.dumps(error))) == call
    assert str(emmy.ResultsError(text)) == call
    assert str(emmy.InputError([("", text, text, None, None)])) == f"{call}; {call}"


def test_a_wrong_argument_of_a_mesh_names_the_mesh():
    with pytest.raises(TypeError, match=r"Mesh\.box\(\) got an unexpected keyword argument 'cell'"):
        emmy.Mesh.box((1, 1, 1), cell=2)
