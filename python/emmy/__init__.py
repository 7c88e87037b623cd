"""Emmy: non-linear elastodynamics by time finite elements that conserve energy and angular momentum.

>>> body = emmy.Body(
...     emmy.Mesh.box((1, 4, 1), (2, 8, 2)),
...     emmy.Region(emmy.NeoHooke(youngs_modulus=1000.0, poissons_ratio=0.3), density=1.0),
... )
>>> motion = emmy.Motion(body, scheme="DGM", steps=(1.0, 0.1), initial=emmy.Initial(angular_velocity=(0, 0, 1)))
>>> history = motion.run()
>>> bool(np.ptp(history["total_energy"]) < 1e-12 * history["total_energy"][0])
True
"""

try:
    from . import _emmy
except ImportError as _error:
    raise ImportError(
        "the compiled part of emmy-fem (emmy._emmy) is missing or does not load; another package named `emmy`, or the "
        f"source tree, may be in its place: {__path__}"
    ) from _error

from . import plot
from ._adjoint import Goal, GoalError, Gradient, Parameter
from ._body import Body, Mobility, Prescribed
from ._contact import Contact, Cylinder, Plane, Sphere
from ._emmy import Step
from ._errors import (
    ConvergenceError,
    EmmyWarning,
    Error,
    Fault,
    InputError,
    LimitExceeded,
    MeshError,
    ResultsError,
    UnknownGroupError,
)
from ._history import Event, History, Peak
from ._joints import Joint
from ._links import Attraction, Bar, Spring
from ._lists import (
    Named,
    elements,
    examples,
    fields,
    materials,
    meshes,
    new,
    schema,
    schemes,
    set_threads,
    solvers,
    threads,
)
from ._materials import Energy, Material
from ._mesh import Mesh
from ._motion import Motion
from ._parts import Adaptive, Coupling, Initial, Load, Mass, Region, Rigid, Support, Tie, Viscosity
from ._results import Frame, Frames, Run
from ._rubber import ArrudaBoyce, Gent, HolzapfelGasserOgden, MooneyRivlin, NeoHookeIsochoric, Ogden, Yeoh
from ._run import Comparison, check, compare, report, resume, run
from ._solids import CiarletGeymonat, Hencky, NeoHooke, Orthotropic, SaintVenantKirchhoff
from ._spectra import Response, response, spectrum
from ._state import Snapshot, State
from ._studies import Convergence, Modes, Problem, converge, equilibrium, load, modes
from ._sweep import Sweep, sweep

__version__ = _emmy.version()

__all__ = [
    "Adaptive", "ArrudaBoyce", "Attraction", "Bar", "Body", "CiarletGeymonat", "Comparison", "Contact", "Convergence",
    "ConvergenceError", "Coupling", "Cylinder", "EmmyWarning", "Energy", "Error", "Event", "Fault", "Frame", "Frames",
    "Gent", "Goal", "GoalError", "Gradient", "Hencky", "History", "HolzapfelGasserOgden", "Initial", "InputError",
    "Joint", "LimitExceeded", "Load", "Mass", "Material", "Mesh", "MeshError", "Mobility", "Modes", "MooneyRivlin",
    "Motion", "Named", "NeoHooke", "NeoHookeIsochoric", "Ogden", "Orthotropic", "Parameter", "Peak", "Plane",
    "Prescribed", "Problem", "Region", "Response", "ResultsError", "Rigid", "Run", "SaintVenantKirchhoff", "Snapshot",
    "Sphere", "Spring", "State", "Step", "Support", "Sweep", "Tie", "UnknownGroupError", "Viscosity", "Yeoh",
    "__version__", "check", "compare", "converge", "elements", "equilibrium", "examples", "fields", "load",
    "materials", "meshes", "modes", "new", "plot", "report", "response", "resume", "run", "schema", "schemes",
    "set_threads", "solvers", "spectrum", "sweep", "threads",
]  # fmt: skip
