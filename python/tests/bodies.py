"""Bodies and motions of several tests.

They are not in `conftest`: processes that tests start import this module by its name, and there are two `conftest`.
"""

import emmy
import numpy as np


def rubber():
    return emmy.NeoHooke(lambda_=1000.0, mu=500.0)


def free_block():
    return emmy.Body(emmy.Mesh.box((1, 2, 1), (1, 2, 1)), emmy.Region(rubber(), density=1.0))


def spinning_block(**arguments):
    initial = emmy.Initial(angular_velocity=(0.5, 1.0, 2.0), gradient=np.diag([0.3, -0.3, 0.0]))
    return emmy.Motion(free_block(), **{"steps": (1.0, 0.05), "initial": initial} | arguments)
