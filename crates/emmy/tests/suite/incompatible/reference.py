"""Numbers of `reference.rs`: two distorted hex8 cells with incompatible modes, in the unknowns (q, a).

The material is mu/2 (J^(-2/3) tr C - 3) + kappa/4 (J^2 - 1 - 2 ln J). DGM treats its energy as one function of C
("whole"), as this library does, or its two parts each with a discrete gradient of its own, the volumetric one on the
path det C -> J ("split"). The split rule is that of the project's independent reference implementation, whose numbers
(probe of the motion, forces of the evaluation) it repeats to 14 digits: a check of the element below.
"""

import itertools

import numpy as np

MU, KAPPA = 20.0, 40.0
EYE = np.eye(3)


def w_iso(C):
    return MU / 2 * (np.linalg.det(C) ** (-1 / 3) * np.trace(C) - 3)


def s_iso(C):
    return MU * np.linalg.det(C) ** (-1 / 3) * (EYE - np.trace(C) / 3 * np.linalg.inv(C))


def u_vol(J):
    return KAPPA / 4 * (J * J - 1 - 2 * np.log(J))


def du_vol(J):
    return KAPPA / 2 * (J - 1 / J)


def w_whole(C):
    return w_iso(C) + u_vol(np.sqrt(np.linalg.det(C)))


def s_whole(C):
    J = np.sqrt(np.linalg.det(C))
    return s_iso(C) + du_vol(J) * J * np.linalg.inv(C)


class Gauss:
    """The Gauss points c, weights b, basis l and its integrals L of degree k."""

    def __init__(self, k):
        points, weights = np.polynomial.legendre.leggauss(k)
        self.k, self.c, self.b = k, (points + 1) / 2, weights / 2
        self.basis = [self.polynomial(i) for i in range(k)]
        integrals = [p.integ() for p in self.basis]
        self.L = [lambda alpha, p=p: p(alpha) - p(0) for p in integrals]
        self.a = np.array([[L(c) for L in self.L] for c in self.c])

    def polynomial(self, i):
        others = np.delete(self.c, i)
        if len(others) == 0:
            return np.polynomial.Polynomial([1.0])
        return np.polynomial.Polynomial.fromroots(others) / np.prod(self.c[i] - others)


def cross(A, B):
    return (np.trace(A) * np.trace(B) - np.sum(A * B)) * EYE - np.trace(A) * B - np.trace(B) * A + A @ B + B @ A


def stresses(gauss, F1, rates, split):
    """First Piola-Kirchhoff stresses of the stages of DGM."""
    k, a, b = gauss.k, gauss.a, gauss.b
    stages = range(k)
    F = [F1 + sum(a[i, j] * rates[j] for j in stages) for i in stages]
    F2 = F1 + sum(b[j] * rates[j] for j in stages)
    dC = [F[i].T @ rates[i] + rates[i].T @ F[i] for i in stages]
    C1, C2 = F1.T @ F1, F2.T @ F2
    C = lambda alpha: C1 + sum(gauss.L[j](alpha) * dC[j] for j in stages)
    energy, stress = (w_iso, s_iso) if split else (w_whole, s_whole)
    quadrature = sum(b[j] * np.sum(stress(C(gauss.c[j])) * dC[j]) / 2 for j in stages)
    r = 2 * (energy(C2) - energy(C1) - quadrature) / sum(b[j] * np.sum(dC[j] ** 2) for j in stages)
    S = [stress(C(gauss.c[i])) + r * dC[i] for i in stages]
    if split:
        S = [S_i + volumetric for S_i, volumetric in zip(S, volumetric_stresses(gauss, C, C1, C2, dC))]
    return [F[i] @ S[i] for i in stages]


def volumetric_stresses(gauss, C, C1, C2, dC):
    k, a, b = gauss.k, gauss.a, gauss.b
    stages = range(k)
    points, weights = np.polynomial.legendre.leggauss(6)
    fine = list(zip((points + 1) / 2, weights / 2))
    M = [sum(w * gauss.basis[i](x) * cross(C(x), C(x)) / 2 for x, w in fine) / b[i] for i in stages]
    d = [np.sum(M[i] * dC[i]) for i in stages]
    J1, J2 = np.sqrt(np.linalg.det(C1)), np.sqrt(np.linalg.det(C2))
    phi = [0.5 / np.sqrt(J1**2 + sum(a[i, j] * d[j] for j in stages)) for i in stages]
    r = sum(b[j] * d[j] * (1 / (J1 + J2) - phi[j]) for j in stages) / sum(b[j] * d[j] ** 2 for j in stages)
    g = [phi[i] + r * d[i] for i in stages]
    dJ = [g[i] * d[i] for i in stages]
    J = [J1 + sum(a[i, j] * dJ[j] for j in stages) for i in stages]
    r = u_vol(J2) - u_vol(J1) - sum(b[j] * du_vol(J[j]) * dJ[j] for j in stages)
    r /= sum(b[j] * dJ[j] ** 2 for j in stages)
    return [2 * (du_vol(J[i]) + r * dJ[i]) * g[i] * M[i] for i in stages]


def place(a, b, c):
    return np.array([2 * a + 0.1 * np.sin(2 * b), b + 0.15 * a * c, c - 0.1 * a * b])


PLACES = [(a, b, c) for c in (0, 1) for b in (0, 1) for a in (0, 0.5, 1)]
X = np.array([place(*p) for p in PLACES])
CELLS = [[first + i for i in (0, 1, 4, 3, 6, 7, 10, 9)] for first in (0, 1)]
PROBE = PLACES.index((1, 1, 1))
CORNERS = np.array([(-1, -1, -1), (1, -1, -1), (1, 1, -1), (-1, 1, -1), (-1, -1, 1), (1, -1, 1), (1, 1, 1), (-1, 1, 1)])


def shape(xi):
    return np.prod(1 + CORNERS * xi, axis=1) / 8


def shape_gradient(xi):
    f = 1 + CORNERS * xi
    return CORNERS * np.stack([f[:, 1] * f[:, 2], f[:, 0] * f[:, 2], f[:, 0] * f[:, 1]], axis=1) / 8


def points():
    """(cell, weight, N, gradients of N, gradients G_m of the modes) of every quadrature point."""
    for index, cell in enumerate(CELLS):
        J0 = X[cell].T @ shape_gradient(np.zeros(3))
        for xi in itertools.product((-(3**-0.5), 3**-0.5), repeat=3):
            xi = np.array(xi)
            J = X[cell].T @ shape_gradient(xi)
            det = np.linalg.det(J)
            modes = np.linalg.det(J0) / det * xi[:, None] * np.linalg.inv(J0)
            yield index, det, shape(xi), shape_gradient(xi) @ np.linalg.inv(J), modes


POINTS = list(points())


def forces(gauss, q, q_rates, a, a_rates, split):
    """Stage forces on the nodes, [k][12][3], and on the modes, [k][2][3][3]; q: displacement of the nodes."""
    f, f_modes = np.zeros((gauss.k, 12, 3)), np.zeros((gauss.k, 2, 3, 3))
    for cell, weight, _, G, modes in POINTS:
        nodes = CELLS[cell]
        F1 = EYE + q[nodes].T @ G + a[cell].T @ modes
        rates = [x[nodes].T @ G + y[cell].T @ modes for x, y in zip(q_rates, a_rates)]
        for i, P in enumerate(stresses(gauss, F1, rates, split)):
            f[i, nodes] += weight * G @ P.T
            f_modes[i, cell] += weight * modes @ P.T
    return f, f_modes


def energy(q, a):
    return sum(w * w_whole(F.T @ F) for w, F in (
        (weight, EYE + q[CELLS[cell]].T @ G + a[cell].T @ modes) for cell, weight, _, G, modes in POINTS))


def evaluation(split):
    g = lambda s: np.array([[0.06 * np.sin(1 + s + 2 * x - y + z / 2), 0.05 * np.cos(0.7 * s + x + 1.5 * y - z),
                             0.04 * np.sin(2 * s - x + y + 2 * z)] for x, y, z in X])
    gauss, zero = Gauss(2), np.zeros((2, 3, 3))
    q, rates, modes = g(0), [1.5 * g(1), 1.5 * g(2)], [zero + 0.02, zero + 0.04]
    f, _ = forces(gauss, q, rates, zero, modes, split)
    h = 1e-4  # central differences of the fourth order along the direction of the tangent
    along = lambda t: forces(gauss, q, [x + t * i * X for i, x in zip((1, 2), rates)], zero, modes, split)[0][:, PROBE]
    tangent = (8 * (along(h) - along(-h)) - along(2 * h) + along(-2 * h)) / (12 * h)
    print("evaluation", "split" if split else "whole")
    print(f[:, PROBE].tolist(), [np.linalg.norm(f_i) for f_i in f], tangent.tolist())


def motion(split):
    """16 steps of 0.025 with DGM of degree 1."""
    mass = np.zeros((12, 12))
    for cell, weight, N, _, _ in POINTS:
        mass[np.ix_(CELLS[cell], CELLS[cell])] += weight * np.outer(N, N)
    v = np.cross([0.3, 0.5, 0.8], X) + X * [0.4, -0.25, -0.15]
    gauss, h = Gauss(1), 0.025
    q, a, x, y = np.zeros((12, 3)), np.zeros((2, 3, 3)), h * v, np.zeros((2, 3, 3))

    def residual(unknowns):
        x, y = unknowns[:36].reshape(12, 3), unknowns[36:].reshape(2, 3, 3)
        f, f_modes = forces(gauss, q, [x], a, [y], split)
        return np.concatenate([(2 * mass @ (x - h * v) + h * h * f[0]).ravel(), (h * h * f_modes).ravel()])

    for step in range(16):
        unknowns = np.concatenate([x.ravel(), y.ravel()])
        if step % 4 == 0:
            columns = [(residual(unknowns + d) - residual(unknowns - d)) / 2e-5 for d in 1e-5 * np.eye(54)]
            inverse = np.linalg.inv(np.array(columns).T)
        for _ in range(30):
            change = inverse @ residual(unknowns)
            unknowns = unknowns - change
            if np.abs(change).max() < 1e-16:
                break
        x, y = unknowns[:36].reshape(12, 3), unknowns[36:].reshape(2, 3, 3)
        q, a, v = q + x, a + y, 2 * x / h - v
    momenta = mass @ v
    print("motion", "split" if split else "whole", "last change", np.abs(change).max())
    print("probe", (X + q)[PROBE].tolist(), "kinetic", 0.5 * np.sum(v * momenta), "strain", energy(q, a))
    print("angular momentum", np.sum(np.cross(X + q, momenta), axis=0).tolist())


for split in (True, False):
    evaluation(split)
    motion(split)
