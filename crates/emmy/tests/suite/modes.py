"""Eigenvalues of the matrices of the test `scipy_finds_the_same_eigenvalues`, in the folder of the crate:

    EMMY_MATRICES=matrices.txt cargo test -p emmy --test suite modes::matrices -- --ignored
    python tests/suite/modes.py matrices.txt
"""

import sys

import numpy as np
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import eigsh

rows, columns, stiffness, mass = np.loadtxt(sys.argv[1], unpack=True)
free, number = np.unique(rows, return_inverse=True)
place = (number, np.searchsorted(free, columns))
K, M = (csc_matrix((values, place)) for values in (stiffness, mass))
values = eigsh(K, 12, M, sigma=0.0, which="LM", tol=1e-13, return_eigenvectors=False)
print("\n".join(f"{value:.12e}" for value in sorted(values)))
