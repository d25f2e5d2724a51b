"""How far flexible bodies sag at rest in MuJoCo and in Filasofia, from the same file of MuJoCo.

    python bench/flex_sag.py        (needs the package and mujoco)

A solid beam is pinned at one side and a sheet at two. MuJoCo gives every node the same mass, Filasofia the mass of its
volume, so each row is measured a second time with Filasofia's masses in MuJoCo.
"""
import pathlib
import tempfile

import filasofia as fs
import mujoco
import numpy as np

SECONDS, STEP = 6.0, 0.001

BEAM = '''<mujoco><option timestep="{step}" integrator="discrete"/><worldbody><body name="wall">
<flexcomp name="flex" type="grid" dim="3" count="9 4 4" spacing="0.02 0.02 0.02" mass="0.2" radius="0.001">
<elasticity young="{young}" poisson="0.3" damping="0.05"/><contact selfcollide="none"/><pin gridrange="0 0 0 0 3 3"/>
</flexcomp></body></worldbody></mujoco>'''

SHEET = '''<mujoco><option timestep="{step}" integrator="discrete"/><worldbody><body name="wall">
<flexcomp name="flex" type="grid" dim="2" count="9 9 1" spacing="0.02 0.02 0.02" mass="0.02" radius="0.001">
<elasticity young="{young}" poisson="{poisson}" thickness="0.001" elastic2d="{kind}" damping="0.02"/>
<contact selfcollide="none"/><pin gridrange="0 0 0 8 8 0 8 8"/></flexcomp></body></worldbody></mujoco>'''


def nodal_share(model, rest):
    """The part of the mass that each node has by volume or area."""
    corners = model.flex_dim[0] + 1
    elements = np.asarray(model.flex_elem).reshape(-1, corners)
    edges = rest[elements[:, 1:]] - rest[elements[:, :1]]
    if corners == 4:
        sizes = np.abs(np.linalg.det(edges))
    else:
        sizes = np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1)
    share = np.zeros(len(rest))
    for corner in range(corners):
        np.add.at(share, elements[:, corner], sizes)
    return share / share.sum()


def mujoco_positions(words, mass=None):
    model = mujoco.MjModel.from_xml_string(words)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    rest = data.flexvert_xpos.copy()
    if mass is not None:
        for node, body in enumerate(model.flex_vertbodyid):
            if model.body_weldid[body]:
                model.body_mass[body] = mass * nodal_share(model, rest)[node]
        mujoco.mj_setConst(model, data)
    for _ in range(round(SECONDS / STEP)):
        mujoco.mj_step(model, data)
    return rest, data.flexvert_xpos


def our_positions(words):
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder) / "model.xml"
        file.write_text(words)
        sim = fs.load(file)
    sim.step(round(SECONDS / STEP))
    x, y, z = sim.frame[sim.bodies[0]].positions.T
    return np.stack([x, -z, y], axis=1)  # our y is up


def row(name, words, mass, where):
    rest, theirs = mujoco_positions(words)
    chosen = where(rest)
    sag = [1e3 * (rest - now)[chosen, 2].mean() for now in (our_positions(words), theirs, mujoco_positions(words, mass)[1])]
    print(f"{name:34} {sag[0]:11.4f} {sag[1]:11.4f} {sag[2]:11.4f} {100 * (sag[0] / sag[2] - 1):9.4f} %")


def end_of_beam(rest):
    return rest[:, 0] > rest[:, 0].max() - 1e-9


def middle_of_sheet(rest):
    return np.abs(rest[:, 0]) < 1e-9


print(f"MuJoCo {mujoco.__version__}; sag at rest [mm]")
print(f"{'':34} {'Filasofia':>11} {'MuJoCo':>11} {'same masses':>11} {'difference':>11}")
for young in (1e4, 3e4, 1e5):
    row(f"beam, E = {young / 1e3:.0f} kPa", BEAM.format(step=STEP, young=young), 0.2, end_of_beam)
for kind, poisson in (("stretch", 0.0), ("stretch", 0.3), ("both", 0.0)):
    row(f"sheet, E = 100 kPa, {kind}, nu = {poisson}",
        SHEET.format(step=STEP, young=1e5, kind=kind, poisson=poisson), 0.02, middle_of_sheet)
