"""The motions of seven examples by other means: the numbers that `examples.rs` compares with.

The same meshes of hex8 and hex20 cells with consistent mass, integrated in time by the classical Runge-Kutta method with
steps so small that halving them changes no digit that is printed. The steel bracket (tet10) deflects so little that its
linear equations are enough, which the trapezoidal rule integrates. The unknowns of the door are the angle of its hinge
and the nodes off its edge, those of the pendulum chain the angles of its links, so that no joint has a constraint.
Nothing of Emmy is in it. Needs numpy and scipy:

    python3 crates/emmy-cli/tests/cli/examples.py [NAME]...
"""

import itertools
import pathlib
import sys

import numpy as np
from scipy.integrate import solve_ivp
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import eigsh, splu

CORNERS = np.array([[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1], [-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]])
# Gmsh's order of the nodes on the edges.
EDGES = [(0, 1), (0, 3), (0, 4), (1, 2), (1, 5), (2, 3), (2, 6), (3, 7), (4, 5), (4, 7), (5, 6), (6, 7)]
NATURAL = np.vstack([CORNERS, [(CORNERS[a] + CORNERS[b]) / 2 for a, b in EDGES]])


def shape(at, n):
    """Shape functions of 8 or 20 nodes and their gradients at a point of the reference cube."""
    N, dN = np.empty(n), np.empty((n, 3))
    for node, corner in enumerate(NATURAL[:n]):
        on_edge = np.flatnonzero(corner == 0)
        factors = [1 - x * x if i in on_edge else 1 + c * x for i, (c, x) in enumerate(zip(corner, at))]
        slopes = [-2 * x if i in on_edge else c for i, (c, x) in enumerate(zip(corner, at))]
        value = np.prod(factors)
        gradient = np.array([slopes[i] * np.prod(np.delete(factors, i)) for i in range(3)])
        if n == 8 or len(on_edge):
            scale, lowered, slope = (1 / 8 if n == 8 else 1 / 4), 1, np.zeros(3)
        else:
            scale, lowered, slope = 1 / 8, corner @ at - 2, corner
        N[node] = scale * value * lowered
        dN[node] = scale * (gradient * lowered + value * slope)
    return N, dN


def gauss(n):
    points, weights = np.polynomial.legendre.leggauss(n)
    return [(np.array(p), np.prod(w)) for p, w in zip(itertools.product(points, repeat=3), itertools.product(weights, repeat=3))]


def saint_venant_kirchhoff(E, nu):
    lam, mu = lame(E, nu)

    def stress(F):
        strain = 0.5 * (np.einsum("...ki,...kj->...ij", F, F) - np.eye(3))
        trace = np.trace(strain, axis1=-2, axis2=-1)
        energy = 0.5 * lam * trace**2 + mu * np.sum(strain**2, axis=(-2, -1))
        return F @ (lam * trace[..., None, None] * np.eye(3) + 2 * mu * strain), energy

    return stress


def neo_hooke(E, nu):
    lam, mu = lame(E, nu)

    def stress(F):
        J = np.log(np.linalg.det(F))
        inverse = np.swapaxes(np.linalg.inv(F), -2, -1)
        energy = 0.5 * mu * (np.sum(F**2, axis=(-2, -1)) - 3) + 0.5 * lam * J**2 - mu * J
        return mu * (F - inverse) + lam * J[..., None, None] * inverse, energy

    return stress


def lame(E, nu):
    return E * nu / ((1 + nu) * (1 - 2 * nu)), E / (2 * (1 + nu))


class Body:
    def __init__(self, points, parts):
        """`parts`: cells, density and stress of each region."""
        self.points, self.parts, n = points, [], len(points)
        rows, columns, entries = [], [], []
        for cells, density, stress in parts:
            k = cells.shape[1]
            shapes = [(*shape(at, k), w) for at, w in gauss(2 if k == 8 else 3)]
            jacobian = [np.einsum("cni,nj->cij", points[cells], dN) for _, dN, _ in shapes]
            gradients = np.array([dN @ np.linalg.inv(J) for (_, dN, _), J in zip(shapes, jacobian)])
            weights = np.array([w * np.linalg.det(J) for (*_, w), J in zip(shapes, jacobian)])
            N = np.array([N for N, *_ in shapes])
            mass = density * np.einsum("pc,pa,pb->cab", weights, N, N)
            rows.append(np.repeat(cells, k, axis=1).ravel())
            columns.append(np.tile(cells, (1, k)).ravel())
            entries.append(mass.ravel())
            self.parts.append((cells, stress, gradients, weights))
        triplets = (np.concatenate(entries), (np.concatenate(rows), np.concatenate(columns)))
        self.mass = csc_matrix(triplets, shape=(n, n))

    def internal(self, u):
        force, energy = np.zeros_like(u), 0.0
        for cells, stress, gradients, weights in self.parts:
            F = np.eye(3) + np.einsum("cai,pcaj->pcij", u[cells], gradients)
            P, W = stress(F)
            np.add.at(force, cells, np.einsum("pcij,pcaj,pc->cai", P, gradients, weights))
            energy += np.sum(weights * W)
        return force, energy

    def energy(self, u, v):
        return 0.5 * np.sum(v * (self.mass @ v)) + self.internal(u)[1]


class BodyWithModes(Body):
    """One region of boxes with the incompatible modes of Simo and Armero: F + sum_m a_m x G_m, G_m = xi_m e_m / (L_m / 2).

    The modes have no mass. `modes` keeps them as the start of the next solution of their equations.
    """

    def __init__(self, points, cells, density, moduli):
        super().__init__(points, [(cells, density, neo_hooke(*moduli))])
        self.moduli = lame(*moduli)
        self.shapes = np.array([2 * at / np.ptp(points[cells], axis=1) for at, _ in gauss(2)])
        self.modes = np.zeros((len(cells), 3, 3))

    def internal(self, u):
        cells, stress, gradients, weights = self.parts[0]
        (lam, mu), G, n = self.moduli, self.shapes, len(cells)
        compatible = np.eye(3) + np.einsum("cai,pcaj->pcij", u[cells], gradients)
        for iteration in range(20):
            F = compatible + np.einsum("cmi,pcm->pcim", self.modes, G)
            P, W = stress(F)
            residual = np.einsum("pcim,pcm,pc->cmi", P, G, weights).reshape(n, 9)
            if iteration > 0 and np.abs(residual).max() < 1e-7:
                break
            inverse, log = np.linalg.inv(F), np.log(np.linalg.det(F))
            terms = (inverse, inverse, G, G, weights)
            K = lam * np.einsum("pcmi,pclk,pcm,pcl,pc->cmilk", *terms, optimize=True)
            K += np.einsum("pcmk,pcli,pcm,pcl,pc,pc->cmilk", *terms, mu - lam * log, optimize=True)
            K += mu * np.einsum("ml,ik,pcm,pcm,pc->cmilk", np.eye(3), np.eye(3), G, G, weights)
            self.modes -= np.linalg.solve(K.reshape(n, 9, 9), residual[..., None]).reshape(n, 3, 3)
        force = np.zeros_like(u)
        np.add.at(force, cells, np.einsum("pcij,pcaj,pc->cai", P, gradients, weights))
        return force, np.sum(weights * W)


def box(size, cells):
    nx, ny, nz = cells
    ticks = [np.linspace(0, s, n + 1) for s, n in zip(size, cells)]
    points = np.array(list(itertools.product(*ticks)))
    node = lambda i, j, k: (i * (ny + 1) + j) * (nz + 1) + k
    corner = (CORNERS + 1) // 2
    cubes = itertools.product(range(nx), range(ny), range(nz))
    return points, np.array([[node(i + a, j + b, k + c) for a, b, c in corner] for i, j, k in cubes])


def march(body, held, external, until, size, start=None, watch=lambda t, u, v: None):
    """Runge-Kutta's method of order four; `held`: nodes with displacement, velocity and acceleration over time."""
    free = np.setdiff1d(np.arange(len(body.points)), held[0])
    factor = splu(body.mass[free][:, free])
    t, (u, v) = start if start else (0.0, (np.zeros_like(body.points), np.zeros_like(body.points)))
    given = held[1]

    def rates(t, u, v):
        place, velocity, acceleration = given(t)
        u, v, a = u.copy(), v.copy(), np.zeros_like(u)
        u[held[0]], v[held[0]], a[held[0]] = place, velocity, acceleration
        force = external(t, u) - body.internal(u)[0] - body.mass @ a
        a[free] = factor.solve(force[free])
        return v, a

    n = round((until - t) / size)
    h = (until - t) / n
    for _ in range(n):
        k1 = rates(t, u, v)
        k2 = rates(t + h / 2, u + h / 2 * k1[0], v + h / 2 * k1[1])
        k3 = rates(t + h / 2, u + h / 2 * k2[0], v + h / 2 * k2[1])
        k4 = rates(t + h, u + h * k3[0], v + h * k3[1])
        u = u + h / 6 * (k1[0] + 2 * k2[0] + 2 * k3[0] + k4[0])
        v = v + h / 6 * (k1[1] + 2 * k2[1] + 2 * k3[1] + k4[1])
        t += h
        u[held[0]], v[held[0]], _ = given(t)
        watch(t, u, v)
    return t, (u, v)


def at_rest(nodes):
    zero = np.zeros((len(nodes), 3))
    return nodes, lambda t: (zero, zero, zero)


def cantilever(step=1.0):
    points, cells = box([1.0, 8.0, 1.0], [2, 16, 2])
    body = Body(points, [(cells, 1000.0, neo_hooke(2e7, 0.3))])
    weight = body.mass @ np.tile([0.0, 0.0, -9.81], (len(points), 1))
    end = np.argmin(np.linalg.norm(points - [0.5, 8.0, 0.5], axis=1))
    seen = []
    watch = lambda t, u, v: seen.append((points[end, 2] + u[end, 2], t))
    march(body, at_rest(np.flatnonzero(points[:, 1] == 0)), lambda t, u: weight, 2.0, step * 5e-4, watch=watch)
    print("cantilever: lowest end_z %.5f at t = %.4f" % min(seen))


def driven_beam(step=1.0):
    points, cells = box([1.0, 8.0, 1.0], [1, 8, 1])
    body = Body(points, [(cells, 1000.0, neo_hooke(2e7, 0.3))])
    foot = np.flatnonzero(points[:, 1] == 0)
    arm = points[foot] - [0.5, 0.0, 0.0]
    turned = lambda c, s: np.stack([c * arm[:, 0] - s * arm[:, 1], s * arm[:, 0] + c * arm[:, 1], 0 * arm[:, 0]], axis=1)

    def given(t):
        c, s, rate = np.cos(t * t), np.sin(t * t), 2 * t
        return turned(c, s) - turned(1, 0), rate * turned(-s, c), 2 * turned(-s, c) - rate**2 * turned(c, s)

    none = lambda t, u: 0.0
    start = march(body, (foot, given), none, 1.0, step * 5e-4)
    energy = body.energy(*start[1])
    end = np.argmin(np.linalg.norm(points - [1.0, 8.0, 0.0], axis=1))
    _, (u, _) = march(body, at_rest(np.array([], dtype=int)), none, 3.0, step * 2.5e-4, start)
    print("driven-beam: energy at the release %.2f, end at t = 3 %s" % (energy, np.round((points + u)[end], 2)))


def balloon(step=1.0):
    points, cells = box([0.2, 0.2, 0.01], [8, 8, 1])
    body = Body(points, [(cells, 1000.0, neo_hooke(1e6, 0.4))])
    rim = np.flatnonzero((points[:, :2] == 0.0).any(axis=1) | np.isclose(points[:, :2], 0.2).any(axis=1))
    faces = cells[:, :4]
    signs = CORNERS[:4, :2]
    corners = [np.array(p) for p in itertools.product([-1 / 3**0.5, 1 / 3**0.5], repeat=2)]

    def pressure(t, u):
        force, q = np.zeros_like(points), (points + u)[faces]
        for x, y in corners:
            N = 0.25 * (1 + signs[:, 0] * x) * (1 + signs[:, 1] * y)
            along = np.einsum("cai,a->ci", q, 0.25 * signs[:, 0] * (1 + signs[:, 1] * y))
            across = np.einsum("cai,a->ci", q, 0.25 * signs[:, 1] * (1 + signs[:, 0] * x))
            # Onto the body from below.
            np.add.at(force, faces, np.einsum("ci,a->cai", np.cross(along, across), N))
        return 3e4 * min(t / 0.01, 1.0) * force

    middle = np.argmin(np.linalg.norm(points - [0.1, 0.1, 0.01], axis=1))
    seen = []
    watch = lambda t, u, v: seen.append((points[middle, 2] + u[middle, 2], t))
    march(body, at_rest(rim), pressure, 0.05, step * 2e-5, watch=watch)
    print("balloon: highest middle_z %.6f at t = %.4f, %.6f at t = 0.05" % (*max(seen), seen[-1][0]))


def two_materials(step=1.0):
    root = pathlib.Path(__file__).resolve().parents[4]
    points, stiff, soft = read_gmsh(root / "examples/meshes/two-materials.msh")
    materials = [(stiff, 2.0, saint_venant_kirchhoff(1e5, 0.25)), (soft, 1.0, neo_hooke(1e3, 0.4))]
    body = Body(points, materials)
    # Shares of a resultant that is spread evenly over the face x = 12: integrals of the shape functions over it.
    spread = np.zeros(len(points))
    for cell in soft:
        face = np.flatnonzero(np.isclose(points[cell, 0], 12))
        if len(face) != 8:
            continue
        axis = next(a for a in range(3) if abs(NATURAL[face, a].sum()) == 8)
        side = NATURAL[face[0], axis]
        for (x, wx), (y, wy) in itertools.product(zip(*np.polynomial.legendre.leggauss(3)), repeat=2):
            at = np.insert([x, y], axis, side)
            N, dN = shape(at, 20)
            tangents = [points[cell].T @ dN[:, a] for a in range(3) if a != axis]
            spread[cell] += wx * wy * np.linalg.norm(np.cross(*tangents)) * N
    spread /= spread.sum()
    force = np.outer(spread, [5.0, 0.0, 15.0])
    tip = np.argmin(np.linalg.norm(points - [12, 2, 1], axis=1))
    held = at_rest(np.flatnonzero(np.isclose(points[:, 0], 0)))
    t, (u, v) = march(body, held, lambda t, u: max(0.0, 1 - abs(t - 0.2) / 0.2) * force, 1.0, step * 1e-3)
    print("two-materials: energy %.5f, tip at t = 1 %s" % (body.energy(u, v), np.round((points + u)[tip], 5)))


TET_EDGES = [(0, 1), (1, 2), (0, 2), (0, 3), (2, 3), (1, 3)]


def tet10(at):
    """Shape functions of Gmsh's quadratic tetrahedron and their gradients."""
    L, dL = np.array([1 - sum(at), *at]), np.vstack([[-1, -1, -1], np.eye(3)])
    N = [l * (2 * l - 1) for l in L] + [4 * L[a] * L[b] for a, b in TET_EDGES]
    dN = [(4 * l - 1) * d for l, d in zip(L, dL)] + [4 * (L[a] * dL[b] + L[b] * dL[a]) for a, b in TET_EDGES]
    return np.array(N), np.array(dN)


def simplex_rule(n, dimension):
    """Gauss points of a cube, collapsed onto a simplex (Duffy)."""
    points, weights = np.polynomial.legendre.leggauss(n)
    points, weights = (points + 1) / 2, weights / 2
    for index in itertools.product(range(n), repeat=dimension):
        at, left, w = [], 1.0, np.prod(weights[list(index)])
        for place, i in enumerate(index):
            at.append(left * points[i])
            w *= left if place else 1.0
            left *= 1 - points[i]
        yield np.array(at), w


def steel_bracket(step=1.0):
    root = pathlib.Path(__file__).resolve().parents[4]
    points, cells = read_gmsh(root / "examples/meshes/steel-bracket.msh")
    n, (lam, mu), density = len(points), lame(2.1e5, 0.3), 7.85e-9
    K, M = np.zeros((len(cells), 30, 30)), np.zeros((len(cells), 10, 10))
    for at, w in simplex_rule(4, 3):
        N, dN = tet10(at)
        J = np.einsum("cni,nj->cij", points[cells], dN)
        w = w * np.linalg.det(J)
        G = dN @ np.linalg.inv(J)
        M += density * np.einsum("c,a,b->cab", w, N, N)
        grad = np.einsum("cai,cbj->caibj", G, G)
        inner = np.einsum("caibi->cab", grad)
        stiffness = lam * grad + mu * np.einsum("caibj->cajbi", grad) + mu * np.einsum("cab,ij->caibj", inner, np.eye(3))
        K += np.einsum("c,cpq->cpq", w, stiffness.reshape(len(cells), 30, 30))
    dofs = (3 * cells[:, :, None] + np.arange(3)).reshape(len(cells), 30)
    sparse = lambda entries, rows, size: csc_matrix(
        (entries.ravel(), (np.repeat(rows, rows.shape[1], axis=1).ravel(), np.tile(rows, (1, rows.shape[1])).ravel())), shape=(size, size))
    K, M = sparse(K, dofs, 3 * n), sparse(np.kron(M, np.eye(3)), dofs, 3 * n)
    # A traction spread evenly over the tip: the midside nodes of a flat triangle take a third of it each, corners none.
    spread = np.zeros(n)
    for cell in cells:
        for corners in itertools.combinations(range(4), 3):
            a, b, c = points[cell[list(corners)]]
            if np.allclose([a[0], b[0], c[0]], 60):
                middle = [4 + TET_EDGES.index(pair) for pair in TET_EDGES if set(pair) <= set(corners)]
                spread[cell[middle]] += np.linalg.norm(np.cross(b - a, c - a)) / 6
    load = np.zeros(3 * n)
    load[2::3] = -spread / spread.sum()
    t, f = np.loadtxt(root / "examples/pulse.csv", delimiter=",", skiprows=2, unpack=True)
    free = np.setdiff1d(np.arange(3 * n), (3 * np.flatnonzero(np.isclose(points[:, 2], 0))[:, None] + np.arange(3)).ravel())
    K, M, load, h = K[free][:, free].tocsc(), M[free][:, free].tocsc(), load[free], step * 1e-6
    factor = splu(M + h * h / 4 * K)
    tip = np.searchsorted(free, 3 * np.argmin(np.linalg.norm(points - [60, 15, 60], axis=1)) + 2)
    u, v, seen = np.zeros(len(free)), np.zeros(len(free)), []
    for i in range(round(5e-3 / h)):
        mean = np.interp([i * h, (i + 1) * h], t, f).mean() * load
        w = factor.solve(M @ v + h / 2 * (mean - K @ u))  # the velocity in the middle
        u, v = u + h * w, 2 * w - v
        seen.append((u[tip], (i + 1) * h))
    (lowest, low), (highest, high) = min(seen), max(seen)
    print("steel-bracket: tip %.4f mm at %.3f ms, %.4f mm at %.3f ms" % (lowest, 1e3 * low, highest, 1e3 * high))
    values = eigsh(K, 6, M, sigma=0.0, return_eigenvectors=False)
    print("steel-bracket: frequencies", np.round(np.sqrt(np.sort(values)) / (2 * np.pi), 2))


def door(step=1.0):
    """The edge turns by an angle; the equation of the angle is that of the forces on the edge, projected on its turning."""
    points, cells = box([0.9, 0.04, 2.0], [4, 1, 4])
    body = BodyWithModes(points, cells, 500.0, (1e8, 0.3))
    edge, free = np.flatnonzero(points[:, 0] == 0), np.flatnonzero(points[:, 0] > 0)
    arm = points - [0.0, 0.02, 0.0]
    M = body.mass.toarray()
    inverse = np.linalg.inv(M[np.ix_(free, free)])
    shares = inverse @ M[np.ix_(free, edge)]
    rest = M[np.ix_(edge, edge)] - M[np.ix_(edge, free)] @ shares
    weight = body.mass @ np.tile([0.0, 0.0, -9.81], (len(points), 1))

    def turned(angle):
        c, s, (x, y, z) = np.cos(angle), np.sin(angle), arm[edge].T
        return np.stack([c * x - s * y, s * x + c * y, 0 * z], axis=1)

    def displacement(u, angle):
        whole = np.zeros_like(points)
        whole[free], whole[edge] = u, turned(angle) - turned(0.0)
        return whole

    def rates(u, v, angle, spin):
        place = turned(angle)
        across = np.stack([-place[:, 1], place[:, 0], 0 * place[:, 0]], axis=1)
        force = weight - body.internal(displacement(u, angle))[0]
        on_edge = force[edge] - shares.T @ force[free] + spin**2 * rest @ place
        torque = np.sum(across * on_edge) - 20.0 * angle - 30.0 * spin
        turning = torque / np.sum(across * (rest @ across))
        return v, inverse @ force[free] - shares @ (turning * across - spin**2 * place), spin, turning

    moved = lambda state, h, k: [own + h * rate for own, rate in zip(state, k)]
    v = 4.0 * np.stack([-arm[free, 1], arm[free, 0], 0 * arm[free, 0]], axis=1)
    state, h = [np.zeros((len(free), 3)), v, 0.0, 4.0], step * 2.5e-5
    for _ in range(round(0.5 / h)):
        k1 = rates(*state)
        k2 = rates(*moved(state, h / 2, k1))
        k3 = rates(*moved(state, h / 2, k2))
        k4 = rates(*moved(state, h, k3))
        state = [own + h / 6 * (a + 2 * b + 2 * c + d) for own, a, b, c, d in zip(state, k1, k2, k3, k4)]
    handle = np.argmin(np.linalg.norm(points - [0.9, 0.0, 1.0], axis=1))
    place = (points + displacement(state[0], state[2]))[handle]
    print("door: angle %.5f at t = 0.5, handle %s" % (state[2], np.round(place, 5)))


def pendulum_chain():
    """Angles of the links from below. The ten links and the ball have the kinetic energy 1/2 sum A_ij cos(a_i - a_j) a_i' a_j'."""
    n, length, mass, ball, g = 10, 0.2, 0.1, 0.2, 9.81
    across = mass * (length**2 + 3 * 0.005**2) / 12
    below = n - 1.0 - np.arange(n)
    A = length**2 * (mass * (np.minimum.outer(below, below) + 0.5) + ball)
    np.fill_diagonal(A, length**2 * (mass * (below + 0.25) + ball) + across)
    weight = g * length * (mass * (below + 0.5) + ball)

    def rates(_, state):
        angle, spin = state[:n], state[n:]
        between = angle[:, None] - angle
        force = -(A * np.sin(between)) @ spin**2 - weight * np.sin(angle)
        return np.concatenate([spin, np.linalg.solve(A * np.cos(between), force)])

    start = np.concatenate([np.full(n, np.pi / 2), np.zeros(n)])
    motion = solve_ivp(rates, (0.0, 1.0), start, method="DOP853", rtol=1e-13, atol=1e-13, t_eval=[0.5, 1.0])
    for t, angle in zip(motion.t, motion.y[:n].T):
        x, z = length * np.sum(np.sin(angle)), -length * np.sum(np.cos(angle))
        print("pendulum-chain: ball at (%.12f, %.12f) at t = %.1f" % (x, z, t))


def read_gmsh(path):
    """Points and the cells of the two volumes, or of the only one, of a file of version 4.1."""
    text = path.read_text().split("\n")
    at = text.index("$Nodes") + 1
    blocks, n = map(int, text[at].split()[:2])
    points, line = np.empty((n, 3)), at + 1
    for _ in range(blocks):
        count = int(text[line].split()[3])
        for i in range(count):
            points[int(text[line + 1 + i]) - 1] = [float(x) for x in text[line + 1 + count + i].split()]
        line += 1 + 2 * count
    at = text.index("$Elements") + 1
    line, volumes = at + 1, {}
    for _ in range(int(text[at].split()[0])):
        dim, tag, _, count = map(int, text[line].split())
        if dim == 3:
            volumes[tag] = np.array([text[line + 1 + i].split()[1:] for i in range(count)], dtype=int) - 1
        line += 1 + count
    return (points, *volumes.values())


if __name__ == "__main__":
    motions = {"cantilever": cantilever, "driven-beam": driven_beam, "balloon": balloon, "two-materials": two_materials,
               "steel-bracket": steel_bracket, "door": door, "pendulum-chain": pendulum_chain}
    for name in sys.argv[1:] or motions:
        motions[name]()
