"""The converged solutions that bench/python_peers.py compares with: a block of tetrahedra in NumPy, without any engine.

Linear tetrahedra, lumped masses, no damping. Motion: velocity Verlet, second order, with steps so small that half of
them change nothing that matters (the table says how much). Equilibrium: Newton's method with the exact tangent.
"""

import numpy as np
import scipy.sparse
import scipy.sparse.linalg

GRAVITY = np.array([0.0, -9.81, 0.0])


def cofactor(f):
    """dJ/dF of matrices (m, 3, 3)."""
    a, b, c = f[..., 0], f[..., 1], f[..., 2]
    return np.stack([np.cross(b, c), np.cross(c, a), np.cross(a, b)], axis=-1)


def st_venant_kirchhoff(f, mu, lam):
    """Filasofia's StVenantKirchhoff, and MuJoCo's flexes."""
    strain = 0.5 * (np.swapaxes(f, -1, -2) @ f - np.eye(3))
    stress = 2 * mu * strain + lam * np.trace(strain, axis1=-2, axis2=-1)[..., None, None] * np.eye(3)
    return f @ stress


def neo_hookean(f, mu, lam):
    """Smith, de Goes and Kim 2018 without the logarithm: Newton's VBD."""
    c = cofactor(f)
    grown = np.einsum("...ij,...ij->...", f, c) / 3 - 1
    return mu * f + ((lam + mu) * grown - mu)[..., None, None] * c


def neo_hookean_ln_j(f, mu, lam):
    """Bonet and Wood 2008: Filasofia's default, as long as no element is below a fifth of its volume."""
    c = cofactor(f)
    volume = np.einsum("...ij,...ij->...", f, c) / 3
    return mu * f + (lam * (volume - 1) - mu / volume)[..., None, None] * c


def neo_hookean_log(f, mu, lam):
    """Smith's with the logarithm: Bullet, and Newton's semi-implicit solver. Constants for the same small strains."""
    mu, lam = 4 / 3 * mu, lam + 5 / 6 * mu
    c = cofactor(f)
    grown = np.einsum("...ij,...ij->...", f, c) / 3 - 1
    square = np.einsum("...ij,...ij->...", f, f)
    return (mu * (1 - 1 / (square + 1)))[..., None, None] * f + (lam * grown - 0.75 * mu)[..., None, None] * c


LAWS = {
    "St. Venant-Kirchhoff": st_venant_kirchhoff,
    "neo-Hookean": neo_hookean,
    "neo-Hookean, ln J": neo_hookean_ln_j,
    "neo-Hookean, log": neo_hookean_log,
}


class Block:
    """A block that is held at its left end: 80 x 40 x 40 mm, 30 kPa, 0.4, 1000 kg/m^3."""

    young, poisson, density, size = 30e3, 0.4, 1000.0, (0.08, 0.04, 0.04)

    def __init__(self, nodes, tetrahedra):
        self.nodes, self.tetrahedra = np.array(nodes, float), np.array(tetrahedra)
        self.mu = self.young / (2 * (1 + self.poisson))
        self.lam = self.young * self.poisson / ((1 + self.poisson) * (1 - 2 * self.poisson))
        self.pinned = self.nodes[:, 0] < self.nodes[:, 0].min() + 1e-6
        edges = np.swapaxes(self.nodes[self.tetrahedra[:, 1:]] - self.nodes[self.tetrahedra[:, :1]], 1, 2)
        self.volumes = np.linalg.det(edges) / 6
        if self.volumes.min() <= 0:
            raise ValueError("a tetrahedron is inside out")
        gradients = np.linalg.inv(edges)
        gradients = np.concatenate([-gradients.sum(axis=1, keepdims=True), gradients], axis=1)  # (m, corner, axis)
        count = len(self.tetrahedra)
        rows = np.broadcast_to(3 * np.arange(count)[:, None, None] + np.arange(3), (count, 4, 3))
        columns = np.broadcast_to(self.tetrahedra[:, :, None], (count, 4, 3))
        self._to_f = scipy.sparse.csr_matrix(
            (gradients.ravel(), (rows.ravel(), columns.ravel())), (3 * count, len(self.nodes))
        )
        self._from_p = self._to_f.T.tocsr()

    def masses(self, equal=False):
        """[kg] a quarter of each tetrahedron to each corner; or `equal` parts of the whole, as Bullet has it."""
        total = self.density * self.volumes.sum()
        if equal:
            return np.full(len(self.nodes), total / len(self.nodes))
        shares = np.repeat(self.density * self.volumes / 4, 4)
        return np.bincount(self.tetrahedra.ravel(), shares, len(self.nodes))

    def deformation(self, x):
        return np.swapaxes((self._to_f @ x).reshape(-1, 3, 3), 1, 2)

    def forces(self, x, law):
        stress = LAWS[law](self.deformation(x), self.mu, self.lam) * self.volumes[:, None, None]
        return -(self._from_p @ np.swapaxes(stress, 1, 2).reshape(-1, 3))

    def motion(self, law, times, dt, equal=False):
        """The nodes at `times` [s], multiples of dt, from rest under gravity."""
        share = np.where(self.pinned, 0.0, 1 / self.masses(equal))[:, None]
        pull = GRAVITY * ~self.pinned[:, None]
        x, v, found = self.nodes.copy(), np.zeros_like(self.nodes), []
        a = pull + share * self.forces(x, law)
        steps = [round(each / dt) for each in times]
        for step in range(1, steps[-1] + 1):
            v += 0.5 * dt * a
            x = x + dt * v
            a = pull + share * self.forces(x, law)
            v += 0.5 * dt * a
            if step in steps:
                found.append(x.copy())
        return found

    def _tangent(self, x, law):
        """The stiffness matrix; the derivative of the stress by a complex step, which has no rounding error."""
        f, tiny = self.deformation(x), 1e-30
        columns = []
        for j in range(3):
            for i in range(3):
                turned = f.astype(complex)
                turned[:, i, j] += 1j * tiny
                columns.append(LAWS[law](turned, self.mu, self.lam).imag / tiny)
        derivative = np.stack(columns, axis=-1) * self.volumes[:, None, None, None]  # (m, i, j, 9)
        blocks = np.swapaxes(derivative, 1, 2).reshape(-1, 9, 9)
        count = len(blocks)
        middle = scipy.sparse.bsr_matrix((blocks, np.arange(count), np.arange(count + 1))).tocsr()
        wide = scipy.sparse.kron(self._to_f, scipy.sparse.identity(3), format="csr")
        return (wide.T @ middle @ wide).tocsc()

    def equilibrium(self, law, equal=False, loads=4):
        """The nodes at rest under gravity."""
        free = np.flatnonzero(np.repeat(~self.pinned, 3))
        weight = self.masses(equal)[:, None] * GRAVITY
        x = self.nodes.copy()
        for load in np.arange(1, loads + 1) / loads:
            for _ in range(30):
                left = (self.forces(x, law) + load * weight).ravel()[free]
                change = scipy.sparse.linalg.spsolve(self._tangent(x, law)[free][:, free], left)
                x.reshape(-1)[free] += change
                if np.abs(change).max() < 1e-12:
                    break
            else:
                raise RuntimeError(f"{law}: no equilibrium was found")
        return x

    def error(self, x, reference):
        """How far apart, relative to how far the reference moved; root mean squares of all nodes."""
        return float(np.linalg.norm(x - reference) / np.linalg.norm(reference - self.nodes))
