"""The L-shaped block of Betsch and Steinmann, thrown by two tractions: energy and angular momentum of its flight."""

import emmy
import numpy as np

force = np.array([256.0, 512.0, 768.0])
hat = [(0.0, 0.0), (0.5, 1.0), (1.0, 0.0)]
body = emmy.Body(
    emmy.Mesh.l_block(cell_size=1.0),
    regions=emmy.Region(emmy.NeoHooke(lambda_=1000.0, mu=500.0), density=0.5),
    loads=[emmy.Load("face-a", traction=force / 9, history=hat),
           emmy.Load("face-b", traction=-force / 9, history=hat)],
)
motion = emmy.Motion(body, scheme="AS(5)", degree=1, steps=[(1.0, 0.01), (4.0, 0.04)])
for step in motion:
    if step.number % 25 == 0:
        print(f"{step.time:5.2f}  T + V = {step.total_energy:.6f}  defect {step.energy_residual:.1e}")

history = motion.history                       # a structured NumPy array with the columns of history.csv
free = history[history["time"] >= 1.0]
print(np.ptp(free["angular_momentum_z"]))      # 1e-12
assert abs(history["total_energy"][-1] - 5500.150056) < 1e-5
