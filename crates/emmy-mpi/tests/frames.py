"""Frames of many processes, as PyVista reads them: frames.py EMMY_MPI EMMY (pip install pyvista; mpirun on the path).

The frames of three ranks have the points, cells and fields of the frames of one process.
"""

import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import pyvista

INPUT = Path(__file__).parent.parent / "inputs" / "l-block.toml"
# Arrays of pieces alone.
OF_RANKS = {"cells": {"rank", "cell"}, "points": {"node"}}
ENVIRONMENT = {
    **os.environ,
    "OMPI_ALLOW_RUN_AS_ROOT": "1",
    "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
    "OMPI_MCA_rmaps_base_oversubscribe": "1",
    "OMPI_MCA_mpi_yield_when_idle": "1",
}


def frames(collection):
    """Times and meshes of a collection."""
    reader = pyvista.get_reader(str(collection))
    for time in reader.time_values:
        reader.set_active_time_value(time)
        yield time, reader.read().combine()


def ordered(mesh):
    """Numbers of the cells by their centres, which pieces have in another order."""
    centres = np.round(mesh.cell_centers().points, 6)
    return np.lexsort(centres.T)


def main():
    program, alone = (str(Path(path).resolve()) for path in sys.argv[1:3])
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        run = ["run", str(INPUT), "--quiet", "--output"]
        of_ranks = ["mpirun", "-n", "3", program, *run, "ranks"]
        subprocess.run(of_ranks, cwd=folder, env=ENVIRONMENT, check=True, timeout=180)
        subprocess.run([alone, *run, "alone"], cwd=folder, check=True, timeout=180)
        pairs = list(zip(frames(folder / "ranks/ranks.pvd"), frames(folder / "alone/alone.pvd"), strict=True))
        assert len(pairs) == 3, len(pairs)
        for (time, own), (other_time, other) in pairs:
            assert time == other_time
            assert own.n_cells == other.n_cells == 117, own.n_cells
            np.testing.assert_allclose(np.array(own.bounds), np.array(other.bounds), atol=1e-5)
            assert set(other.cell_data) | OF_RANKS["cells"] == set(own.cell_data), own.cell_data
            assert set(other.point_data) | OF_RANKS["points"] <= set(own.point_data), own.point_data
            own_order, other_order = ordered(own), ordered(other)
            for name in other.cell_data:
                fields = own.cell_data[name][own_order], other.cell_data[name][other_order]
                scale = np.abs(fields[1]).max() + 1e-30
                np.testing.assert_allclose(fields[0] / scale, fields[1] / scale, atol=1e-5, err_msg=name)
            assert set(np.unique(own.cell_data["rank"])) == {0, 1, 2}
            # Values at nodes: the mean over the corners of each cell.
            means = own.point_data_to_cell_data(), other.point_data_to_cell_data()
            for name in other.point_data:
                fields = means[0].cell_data[name][own_order], means[1].cell_data[name][other_order]
                scale = np.abs(fields[1]).max() + 1e-30
                np.testing.assert_allclose(fields[0] / scale, fields[1] / scale, atol=1e-5, err_msg=name)
        page = (folder / "ranks/report.html").read_text()
        assert "<html" in page
        print(f"{len(pairs)} frames of 3 ranks equal those of one process")


if __name__ == "__main__":
    main()
