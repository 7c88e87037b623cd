"""Steps by hand, a function as history, snapshots, observers: the L-shaped block, pushed on one side."""

import emmy
import numpy as np

force = np.array([256.0, 512.0, 768.0])
mesh = emmy.Mesh.l_block(cell_size=1.0)
region = emmy.Region(emmy.NeoHooke(lambda_=1000.0, mu=500.0), density=0.5)

push = emmy.Load("face-a", traction=force / 9, history=lambda t: np.sin(np.pi * t) ** 4 if t < 1 else 0.0)
body = emmy.Body(mesh, region, loads=push)
motion = emmy.Motion(body, scheme="AS(5)", degree=2)
while motion.time < 1.0:
    motion.step(0.01)
positions = motion.positions                    # (n_nodes, 3), a copy: keep it as long as you like
snapshot = motion.snapshot()                    # picklable; snapshot.save("a.emmy"), emmy.Snapshot.load("a.emmy")
plan = (4.0, 0.04)
other = emmy.Motion(body, scheme="AS(5)", degree=2, steps=plan, start=snapshot)      # goes on in every bit as motion would
other.run(observers=[lambda step, motion: step.time > 2.0])                          # a true answer stops; other.run() goes on
