"""bench/peer_reference.py: what engines are compared with obeys its laws, and Filasofia comes to the same."""
import os
import sys

import numpy as np
import pytest

pytest.importorskip("scipy", reason="pip install scipy")
sys.path.insert(0, os.path.join(os.environ["FILASOFIA_ROOT"], "bench"))

import filasofia as fs  # noqa: E402
from peer_engines import Filasofia  # noqa: E402
from peer_reference import LAWS, Block  # noqa: E402


@pytest.fixture(scope="module")
def block():
    mesh = fs.shapes.block(Block.size, (4, 2, 2))
    return Block(mesh.nodes, mesh.tetrahedra)


@pytest.mark.parametrize("law", LAWS)
def test_every_law_is_hookes_at_small_strain_and_comes_from_an_energy(law, block):
    draw = np.random.default_rng(0)
    small = 1e-6 * draw.normal(size=(3, 3))
    strain = 0.5 * (small + small.T)
    hooke = 2 * block.mu * strain + block.lam * np.trace(strain) * np.eye(3)
    stress = LAWS[law]((np.eye(3) + small)[None], block.mu, block.lam)[0]
    assert np.allclose(stress, hooke, rtol=0, atol=1e-5 * np.abs(hooke).max())
    far = np.eye(3) + 0.3 * draw.normal(size=(3, 3))
    tangent = np.zeros((9, 9))
    for k in range(9):
        step = np.zeros(9)
        step[k] = 1e-6
        ahead, behind = (LAWS[law]((far + s * step.reshape(3, 3))[None], block.mu, block.lam) for s in (1, -1))
        tangent[:, k] = (ahead - behind).ravel() / 2e-6
    assert np.allclose(tangent, tangent.T, atol=1e-6 * np.abs(tangent).max())  # the second derivative of an energy


@pytest.mark.parametrize("law", LAWS)
def test_forces_balance_and_the_tangent_is_their_derivative(law, block):
    draw = np.random.default_rng(1)
    x = block.nodes + 5e-4 * draw.normal(size=block.nodes.shape)
    force = block.forces(x, law)
    assert np.abs(force.sum(axis=0)).max() < 1e-12 * np.abs(force).sum()
    way = draw.normal(size=x.shape)
    change = (block.forces(x - 1e-8 * way, law) - block.forces(x + 1e-8 * way, law)) / 2e-8
    assert np.allclose(block._tangent(x, law) @ way.ravel(), change.ravel(), rtol=0, atol=1e-5 * np.abs(change).max())


def test_masses_are_the_bodys(block):
    weight = block.density * np.prod(block.size)
    assert block.masses().sum() == pytest.approx(weight) and block.masses(equal=True).sum() == pytest.approx(weight)


def test_the_motion_is_converged_and_the_equilibrium_is_at_rest(block):
    coarse, fine = (block.motion("neo-Hookean", (0.1,), dt)[0] for dt in (2e-4, 1e-4))
    assert block.error(coarse, fine) < 1e-4
    rest = block.equilibrium("neo-Hookean")
    left = block.forces(rest, "neo-Hookean") + block.masses()[:, None] * (0, -9.81, 0)
    assert np.abs(left[~block.pinned]).max() < 1e-9


@pytest.mark.parametrize("law", Filasofia.LAWS)
def test_filasofia_comes_to_the_reference_as_its_steps_get_smaller(law, block):
    expected = block.motion(law, (0.1,), 1e-4)[0]
    errors = []
    for scheme, dt in (("implicit", 2e-3), ("implicit", 1e-3), ("explicit", 2e-4)):
        engine = Filasofia(block, dt, law=law, scheme=scheme)
        for _ in range(round(0.1 / dt)):
            engine.step()
        errors.append(block.error(engine.nodes(), expected))
        engine.sim.close()
    assert errors[1] < 0.6 * errors[0] and errors[2] < 1e-3
    engine = Filasofia(block, 5e-3, damping=0.05, law=law)
    for _ in range(300):
        engine.step()
    assert block.error(engine.nodes(), block.equilibrium(law)) < 1e-3
    engine.sim.close()
