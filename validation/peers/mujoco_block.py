"""The thrown block in MuJoCo 4: `mujoco_block.py INTEGRATOR STEP [MASSES]`, which prints the lines `time,energy`.

The problem is that of `validation/inputs/contact/block.toml`. Integrators: `Euler`, semi-implicit, which is the method
of leapfrog with velocities half a step late; `RK4`; `discrete`, which is implicit, linear in a step, and dissipates.
`implicit` and `implicitfast` refuse the elasticity of a flex.

The body is a flex of 27 vertices and 48 tetrahedra of St. Venant-Kirchhoff material with the moduli of the input,
without damping. Masses: `lumped`, the trapezoidal rule, with 1.5 times the moments of inertia and 1.137 times the
energy of the input at the start; `simpson`, with those of the input, but light corners, which need smaller steps.

Contact is frictionless, of vertices with the radius of the layer. Its impedance is the smallest, 1e-4: then the force
is that of a spring, to 1e-4 of the other forces on a vertex, and the stiffness per area is that of the linear law of
the layer where it begins.

The energy is kinetic, elastic and, during contact too, that of the contact springs, at the positions and velocities
of MuJoCo's state. `mjData.energy` has neither that of a flex of tetrahedra nor that of contact, so both are computed
here. Free vibration without the plane keeps the sum to 1e-8 (RK4, steps of 1e-4).
"""
import sys

import mujoco
import numpy as np

LAMBDA, MU = 1000.0, 500.0
DISTANCE, STIFFNESS, PLANE = 0.05, 1333.0, -0.06
VELOCITY, SPIN, ABOUT = [0.3, 0.1, -2.0], [0.5, 3.0, 0.0], [0.5, 0.5, 0.5]
END = 0.24
MASSES = {"lumped": (1 / 4, 1 / 2, 1 / 4), "simpson": (1 / 6, 2 / 3, 1 / 6)}

MODEL = """
<mujoco>
  <option integrator="{integrator}" timestep="{step}" gravity="0 0 0"/>
  <worldbody>
    <geom type="plane" size="9 9 1" pos="0 0 {plane}" condim="1" priority="1" solref="-{stiffness} 0"
          solimp="1e-4 1e-4 1"/>
    <flexcomp name="block" type="grid" dim="3" count="3 3 3" spacing="0.5 0.5 0.5" pos="0.5 0.5 0.5" mass="1"
              radius="{radius}">
      <elasticity young="{young}" poisson="{poisson}" damping="0"/>
      <contact selfcollide="none" condim="1"/>
    </flexcomp>
  </worldbody>
</mujoco>
"""


class Block:
    """The block at its start, with what its energy needs."""

    def __init__(self, integrator: str, step: float, masses: str = "lumped") -> None:
        weights = np.array(MASSES[masses])
        # Of a vertex and per mass: area over mass is one over the weight of the first point, on every face.
        self.stiffness = STIFFNESS / DISTANCE / MASSES[masses][0]
        self.model = mujoco.MjModel.from_xml_string(
            MODEL.format(
                integrator=integrator,
                step=step,
                plane=PLANE,
                stiffness=self.stiffness,
                radius=DISTANCE,
                young=MU * (3 * LAMBDA + 2 * MU) / (LAMBDA + MU),
                poisson=LAMBDA / (2 * (LAMBDA + MU)),
            )
        )
        self.data = mujoco.MjData(self.model)
        mujoco.mj_kinematics(self.model, self.data)
        bodies = self.model.flex_vertbodyid
        self.places = self.data.xpos[bodies].copy()
        self.masses = weights[np.rint(2 * self.places).astype(int)].prod(axis=1)
        self.model.body_mass[bodies] = self.masses
        mujoco.mj_setConst(self.model, self.data)
        self.data.qvel[:] = (VELOCITY + np.cross(SPIN, self.places - ABOUT)).ravel()
        self.cells = self.model.flex_elem.reshape(-1, 4)
        edges = self.edges(self.places)
        self.inverses, self.volumes = np.linalg.inv(edges), np.abs(np.linalg.det(edges)) / 6

    def edges(self, places: np.ndarray) -> np.ndarray:
        """Edges from the first vertex of each tetrahedron, as columns."""
        corners = places[self.cells]
        return np.swapaxes(corners[:, 1:] - corners[:, :1], 1, 2)

    def positions(self) -> np.ndarray:
        """Positions of the vertices."""
        return self.places + self.data.qpos.reshape(-1, 3)

    def velocities(self) -> np.ndarray:
        """Velocities of the vertices."""
        return self.data.qvel.reshape(-1, 3)

    def kinetic(self) -> float:
        """Kinetic energy."""
        return 0.5 * float(self.masses @ np.square(self.velocities()).sum(axis=1))

    def elastic(self) -> float:
        """Energy of the St. Venant-Kirchhoff material."""
        gradients = self.edges(self.positions()) @ self.inverses
        strains = (np.swapaxes(gradients, 1, 2) @ gradients - np.eye(3)) / 2
        traces = np.trace(strains, axis1=1, axis2=2)
        return float(self.volumes @ (LAMBDA / 2 * traces**2 + MU * np.square(strains).sum(axis=(1, 2))))

    def contact(self) -> float:
        """Energy of the contact springs."""
        depths = np.maximum(PLANE + DISTANCE - self.positions()[:, 2], 0)
        return 0.5 * self.stiffness * float(self.masses @ depths**2)

    def energy(self) -> float:
        """Total energy."""
        return self.kinetic() + self.elastic() + self.contact()


def main(integrator: str, step: str, masses: str = "lumped") -> None:
    """Run and print."""
    # In the place of a log file. One comes with every body of tetrahedra: that it has no forces, which it has.
    told: list[str] = []
    mujoco.set_mju_user_warning(told.append)
    try:
        block = Block(integrator, float(step), masses)
        told.clear()
        print("time,energy")
        print(f"0.0,{block.energy()!r}")
        for _ in range(round(END / float(step))):
            mujoco.mj_step(block.model, block.data)
            # MuJoCo would go on from the first state.
            if told:
                sys.exit(f"{integrator}, {step}: {told[0]}")
            print(f"{block.data.time!r},{block.energy()!r}")
    except (mujoco.FatalError, ValueError) as error:
        sys.exit(f"{integrator}, {step}: {error}")
    finally:
        mujoco.set_mju_user_warning(None)


if __name__ == "__main__":
    main(*sys.argv[1:])
