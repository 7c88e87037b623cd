"""Writes tied-blocks.msh, in this directory: two blocks of 2 x 2 x 1, one on the other, whose meshes do not match.

Volumes "lower" with 2 x 2 x 2 hexahedra and "upper" with 3 x 3 x 2; surfaces "lower-face" and "upper-face" between
them.
"""

from itertools import product
from pathlib import Path

HEX8 = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
QUAD4 = HEX8[:4]

# Block: number of cells along x and y, height of its lower face, layer of nodes at the other block.
BLOCKS = [(2, 0.0, 2), (3, 1.0, 0)]

lines = ["$MeshFormat", "4.1 0 8", "$EndMeshFormat", "$PhysicalNames", "4"]
lines += ['2 3 "lower-face"', '2 4 "upper-face"', '3 1 "lower"', '3 2 "upper"', "$EndPhysicalNames"]
lines += ["$Entities", "0 0 2 2"]
lines += [f"{tag} 0 0 1 2 2 1 1 {tag + 2} 0" for tag in (1, 2)]
lines += [f"{tag} 0 0 {low:g} 2 2 {low + 1:g} 1 {tag} 1 {tag}" for tag, (_, low, _) in enumerate(BLOCKS, 1)]
lines += ["$EndEntities"]

nodes, facets, cells = [], [], []
for n, low, layer in BLOCKS:
    first = len(nodes) + 1

    def node(i, j, k):
        return first + (k * (n + 1) + j) * (n + 1) + i

    nodes += [(2 * i / n, 2 * j / n, low + k / 2) for k, j, i in product(range(3), range(n + 1), range(n + 1))]
    facets.append([[node(i + a, j + b, layer) for a, b, _ in QUAD4] for j, i in product(range(n), range(n))])
    corners = [(i, j, k) for k, j, i in product(range(2), range(n), range(n))]
    cells.append([[node(i + a, j + b, k + c) for a, b, c in HEX8] for i, j, k in corners])

sizes = [3 * (n + 1) ** 2 for n, _, _ in BLOCKS]
lines += ["$Nodes", f"2 {len(nodes)} 1 {len(nodes)}"]
for tag, size in enumerate(sizes, 1):
    first = sum(sizes[: tag - 1])
    own = range(first, first + size)
    lines += [f"3 {tag} 0 {size}", *(str(number + 1) for number in own)]
    lines += [" ".join(f"{x:.17g}" for x in nodes[number]) for number in own]
lines += ["$EndNodes"]

n_elements = sum(map(len, facets + cells))
lines += ["$Elements", f"4 {n_elements} 1 {n_elements}"]
number = 0
for dimension, kind, all_of_dimension in ((2, 3, facets), (3, 5, cells)):
    for tag, own in enumerate(all_of_dimension, 1):
        lines.append(f"{dimension} {tag} {kind} {len(own)}")
        for corners in own:
            number += 1
            lines.append(" ".join(map(str, [number, *corners])))
lines += ["$EndElements"]

Path("tied-blocks.msh").write_text("\n".join(lines) + "\n")
