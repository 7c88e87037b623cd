"""Docstrings in NumPy's style: every public name describes what goes in, what comes out, and what is raised."""

import ast
import builtins
import dataclasses
import doctest
import inspect
import textwrap

import emmy
import pytest
from numpydoc import validate as numpydoc

from bodies import free_block

#: Checks that are left out, with the reason.
LEFT_OUT = {
    "ES01": "a summary often suffices",
    "RT03": "so does the type of a result",
    "SA01": "names in backticks refer to others",
    "SS05": "summaries say what a function does: `Reads a mesh`",
}
#: Classes whose objects the package makes: `Attributes` describe them, not the arguments of their constructors.
MADE_BY_THE_PACKAGE = {
    "Comparison", "Convergence", "ConvergenceError", "Event", "Fault", "Frame", "Frames", "Goal", "GoalError",
    "Gradient", "History", "Mobility", "Modes", "Named", "Peak", "Prescribed", "Problem", "Response", "Snapshot",
    "Sweep",
}  # fmt: skip
#: Names that raise nothing but what wrong types raise.
RAISE_NOTHING = {
    "Body.to_toml", "Mesh.boundary", "Motion.snapshot", "Problem.motion", "elements", "examples", "fields", "materials",
    "meshes", "schema", "schemes", "solvers",
}  # fmt: skip
#: pytest does not find the examples in compiled classes.
COMPILED = {"Step"}
#: What the helpers in a `raise` return.
HELPERS = {"fault": "InputError", "missing": "ImportError"}

CLASSES = {name: getattr(emmy, name) for name in emmy.__all__ if inspect.isclass(getattr(emmy, name))}
FUNCTIONS = {name: getattr(emmy, name) for name in emmy.__all__ if inspect.isfunction(getattr(emmy, name))}
#: Names in the module `emmy.plot`.
OF_PLOT = {f"plot.{name}": getattr(emmy.plot, name) for name in emmy.plot.__all__}


def members(kinds):
    """Public members of the public classes by their names, those of a base class once."""
    found = {}
    for name, own in CLASSES.items():
        for base in own.__mro__:
            if base.__module__.partition(".")[0] == "emmy":
                for member, value in vars(base).items():
                    if isinstance(value, kinds) and not member.startswith("_"):
                        found.setdefault(value, f"{name}.{member}")
    return {name: value for value, name in found.items()}


METHODS = members((classmethod, staticmethod, type(lambda: None)))
PROPERTIES = members(property)
CALLABLES = FUNCTIONS | OF_PLOT | {name: getattr(value, "__func__", value) for name, value in METHODS.items()}


def parsed(name):
    return numpydoc.Validator(numpydoc.get_doc_object(numpydoc.Validator._load_obj(f"emmy.{name}")))


def faults(name, *, without=()):
    errors = numpydoc.validate(f"emmy.{name}")["errors"]
    return [error for error in errors if error[0] not in (*LEFT_OUT, *without)]


def test_every_name_is_checked():
    assert set(emmy.__all__) == set(CLASSES) | set(FUNCTIONS) | {"__version__", "plot"}
    assert MADE_BY_THE_PACKAGE | COMPILED <= set(CLASSES)
    assert set(CALLABLES) >= RAISE_NOTHING
    # Those of the main classes, and of bases that are not public.
    assert {"Body.mass", "Mesh.read", "Motion.run", "Motion.field", "Goal.displacement_at"} <= set(METHODS)
    assert {"Body.mesh", "Motion.displacement", "Run.history"} <= set(PROPERTIES)


@pytest.mark.parametrize("name", sorted(set(CLASSES) - COMPILED - MADE_BY_THE_PACKAGE))
def test_class(name):
    assert faults(name) == []


@pytest.mark.parametrize("name", sorted(MADE_BY_THE_PACKAGE))
def test_class_made_by_the_package(name):
    assert faults(name, without=("PR01",)) == []
    own = CLASSES[name]
    documented = [each.strip() for entry in parsed(name).doc["Attributes"] for each in entry.name.split(",")]
    if dataclasses.is_dataclass(own):
        assert documented == [field.name for field in dataclasses.fields(own)]
    elif hasattr(own, "_fields"):
        assert documented == list(own._fields)
    else:
        attributes = set(dir(own)) | set(own.__annotations__) | set(inspect.signature(own).parameters)
        assert set(documented) <= attributes


@pytest.mark.parametrize("name", sorted(COMPILED))
def test_compiled_class(name):
    # Comments of Rust have no quotes; objects are made by the package.
    assert faults(name, without=("GL02", "PR01")) == []
    example = doctest.DocTestParser().get_doctest(CLASSES[name].__doc__, {"emmy": emmy}, name, None, None)
    results = doctest.DocTestRunner().run(example)
    assert results.attempted > 0 and results.failed == 0
    step = emmy.Motion(free_block()).step(0.1)
    documented = {each.strip() for entry in parsed(name).doc["Attributes"] for each in entry.name.split(",")}
    public = {each for each in CLASSES[name].__dict__ if not each.startswith("_")}
    assert public <= documented and all(hasattr(step, each) for each in documented)


@pytest.mark.parametrize("name", sorted(CALLABLES))
def test_function(name):
    assert faults(name) == []
    doc = parsed(name).doc
    returns = inspect.signature(CALLABLES[name]).return_annotation
    assert bool(doc["Returns"]) == (returns not in (None, "None"))


@pytest.mark.parametrize("name", sorted(PROPERTIES))
def test_property(name):
    assert faults(name, without=("EX01",)) == []


def made_by(own):
    """The functions that make an object of a class, but those that `dataclasses` writes."""
    functions = [
        inspect.unwrap(vars(own)[name]) for name in ("__init__", "__post_init__", "_check") if name in vars(own)
    ]
    return [function for function in functions if function.__code__.co_filename == inspect.getsourcefile(own)]


def raised_in(function):
    """Names of the exceptions in the source of a function."""
    tree = ast.parse(textwrap.dedent(inspect.getsource(function)))
    names = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Raise) and isinstance(node.exc, ast.Call) and isinstance(node.exc.func, ast.Name):
            names.add(HELPERS.get(node.exc.func.id, node.exc.func.id))
    return names


@pytest.mark.parametrize("name", sorted(set(CLASSES) - COMPILED | set(CALLABLES)))
def test_raises(name):
    doc = parsed(name).doc
    documented = {each.strip() for entry in doc["Raises"] for each in entry.type.split(",")}
    for each in documented:
        error = getattr(emmy, each, None) or getattr(builtins, each)
        assert issubclass(error, BaseException)
    assert all("".join(entry.desc).endswith(".") for entry in doc["Raises"])
    for function in made_by(CLASSES[name]) if name in CLASSES else [CALLABLES[name]]:
        assert raised_in(function) <= documented
    if name in CALLABLES:
        assert bool(documented) == (name not in RAISE_NOTHING)
