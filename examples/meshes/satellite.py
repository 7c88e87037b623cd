"""Writes satellite.msh, in this directory: two panels of 3 x 1 x 0.4 with a gap of 1 between them.

Volumes "right" and "left" with 3 x 1 x 1 hexahedra each; surfaces "right-root" and "left-root" at the gap.
"""

from itertools import product
from pathlib import Path

HEX8 = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
FACE = [(0, 0), (1, 0), (1, 1), (0, 1)]

# Panel: its smallest x, layer of nodes at the gap.
PANELS = [(0.5, 0), (-3.5, 3)]
N = 4 * 2 * 2

lines = ["$MeshFormat", "4.1 0 8", "$EndMeshFormat", "$PhysicalNames", "4"]
lines += ['2 3 "right-root"', '2 4 "left-root"', '3 1 "right"', '3 2 "left"', "$EndPhysicalNames"]
lines += ["$Entities", "0 0 2 2"]
lines += [f"{tag} {low + layer:g} -0.5 0 {low + layer:g} 0.5 0.4 1 {tag + 2} 0" for tag, (low, layer) in enumerate(PANELS, 1)]
lines += [f"{tag} {low:g} -0.5 0 {low + 3:g} 0.5 0.4 1 {tag} 1 {tag}" for tag, (low, _) in enumerate(PANELS, 1)]
lines += ["$EndEntities"]


def node(panel, i, j, k):
    return panel * N + (k * 2 + j) * 4 + i + 1


lines += ["$Nodes", f"2 {2 * N} 1 {2 * N}"]
for panel, (low, _) in enumerate(PANELS):
    lines += [f"3 {panel + 1} 0 {N}", *(str(panel * N + number + 1) for number in range(N))]
    lines += [f"{low + i:g} {j - 0.5:g} {0.4 * k:g}" for k, j, i in product(range(2), range(2), range(4))]
lines += ["$EndNodes"]

lines += ["$Elements", "4 8 1 8"]
for panel, (_, layer) in enumerate(PANELS):
    corners = [node(panel, layer, j, k) for j, k in FACE]
    lines += [f"2 {panel + 1} 3 1", " ".join(map(str, [panel + 1, *corners]))]
for panel in range(2):
    lines.append(f"3 {panel + 1} 5 3")
    for i in range(3):
        corners = [node(panel, i + a, b, c) for a, b, c in HEX8]
        lines.append(" ".join(map(str, [3 + 3 * panel + i, *corners])))
lines += ["$EndElements"]

Path("satellite.msh").write_text("\n".join(lines) + "\n")
