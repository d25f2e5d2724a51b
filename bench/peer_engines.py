"""Engines that install from PyPI, each with the block of peer_reference.py: what bench/python_peers.py measures.

An engine is a class with `law`, `equal` (masses), step() and nodes(); its parameters are the block, dt [s], damping [s],
by which the stiffness is multiplied, and options of its own. It uses one thread.
"""

import contextlib
import os
import tempfile

import numpy as np


class Filasofia:
    """`scheme` "implicit" is the default: linearised backward Euler; "explicit" is symplectic Euler."""

    package, equal = "filasofia", False
    LAWS = {"neo-Hookean, ln J": "NeoHookean", "St. Venant-Kirchhoff": "StVenantKirchhoff"}

    def __init__(self, block, dt, damping=0.0, law="neo-Hookean, ln J", scheme="implicit"):
        import filasofia as fs

        self.law = law
        explicit = fs.ExplicitEuler(symplectic=True)
        left = block.nodes[:, 0].min() + 1e-6
        self.sim = fs.Simulation(rate=1 / dt, threads=1)
        self.body = self.sim.add(
            fs.SoftBodyDef(
                name="block",
                mesh=fs.TetMesh(nodes=block.nodes, tetrahedra=block.tetrahedra),
                material=fs.FemMaterial(
                    young_modulus=block.young, poisson_ratio=block.poisson, law=getattr(fs, self.LAWS[law])()
                ),
                mass=fs.Density(block.density),
                rayleigh=fs.Rayleigh(mass=0, stiffness=damping),
                integrator=explicit if scheme == "explicit" else fs.ImplicitEuler(),
                attachments=[fs.AttachmentDef(box=fs.Box((-1, -1, -1), (left, 1, 1)))],
            )
        )
        self.step = self.sim.step

    def broken(self):
        """Whether a step was undone, or turned an element inside out: without contacts, it is unstable."""
        report = self.sim.report()
        return report.undone > 0 or report.inverted > 0

    def nodes(self):
        return self.sim.frame[self.body].positions

    @staticmethod
    def version():
        import filasofia

        return filasofia.__version__


def mujoco_model(block, dt, damping, scheme):
    """A flex with the block's nodes and tetrahedra; a body gets the mass of its node."""
    import mujoco

    mujoco.set_mju_user_warning(lambda message: None)  # broken() says it; the default writes a file, too
    option = {"implicit": 'integrator="discrete" solver="CG" tolerance="1e-6"', "explicit": 'integrator="Euler"'}[scheme]
    words = [" ".join(map(repr, part.ravel().tolist())) for part in (block.nodes, block.tetrahedra)]
    model = mujoco.MjModel.from_xml_string(
        f"""<mujoco><option timestep="{dt}" {option} gravity="0 -9.81 0"><flag contact="disable"/></option><worldbody>
        <flexcomp name="block" type="direct" dim="3" point="{words[0]}" element="{words[1]}" mass="1" radius="0.001">
        <elasticity young="{block.young}" poisson="{block.poisson}" damping="{damping}"/>
        <contact selfcollide="none" contype="0" conaffinity="0"/>
        <pin id="{" ".join(map(str, np.flatnonzero(block.pinned)))}"/></flexcomp></worldbody></mujoco>"""
    )
    free = np.flatnonzero(~block.pinned)
    model.body_mass[model.flex_vertbodyid[free]] = block.masses()[free]
    mujoco.mj_setConst(model, mujoco.MjData(model))
    return model


class MuJoCo:
    """`scheme` "implicit" is the integrator that its documentation advises for flexes ("discrete"), with CG."""

    package, equal, law = "mujoco", False, "St. Venant-Kirchhoff"
    cannot = (
        "no law but St. Venant-Kirchhoff in MJCF; a flex spreads its mass evenly, so the masses of nodes are set afterwards"
    )

    def __init__(self, block, dt, damping=0.0, scheme="implicit"):
        import mujoco

        self._mujoco, self.model = mujoco, mujoco_model(block, dt, damping, scheme)
        self.data = mujoco.MjData(self.model)

    def step(self):
        self._mujoco.mj_step(self.model, self.data)

    def broken(self):
        """Whether it has found its state unstable, and begun anew."""
        return self.data.warning[self._mujoco.mjtWarning.mjWARN_BADQACC].number > 0

    def nodes(self):
        self._mujoco.mj_kinematics(self.model, self.data)
        self._mujoco.mj_flex(self.model, self.data)
        return self.data.flexvert_xpos.copy()

    @staticmethod
    def version():
        import mujoco

        return mujoco.__version__


@contextlib.contextmanager
def quiet():
    """C libraries print to the file descriptor."""
    kept, nowhere = os.dup(1), os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    try:
        yield
    finally:
        os.dup2(kept, 1)
        os.close(kept)
        os.close(nowhere)


def write_vtk(block, file):
    with open(file, "w") as out:
        out.write(f"# vtk DataFile Version 2.0\nblock\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS {len(block.nodes)} double\n")
        out.writelines("%.17g %.17g %.17g\n" % tuple(each) for each in block.nodes)
        count = len(block.tetrahedra)
        out.write(f"\nCELLS {count} {5 * count}\n")
        out.writelines("4 %d %d %d %d\n" % tuple(each) for each in block.tetrahedra)
        out.write(f"\nCELL_TYPES {count}\n" + "10\n" * count)


class PyBullet:
    """Its deformable world: explicit elasticity, implicit damping. Every node has the same mass: it takes only the total."""

    package, equal, law = "pybullet", True, "neo-Hookean, log"
    cannot = (
        "no implicit elasticity, no mass per node, no batches; Young's modulus and Poisson's ratio must be converted"
    )

    def __init__(self, block, dt, damping=0.0, scheme="explicit"):
        with quiet():
            import pybullet

            self._bullet, self._client = pybullet, pybullet.connect(pybullet.DIRECT)
            here = {"physicsClientId": self._client}
            pybullet.resetSimulation(pybullet.RESET_USE_DEFORMABLE_WORLD, **here)
            pybullet.setGravity(0, -9.81, 0, **here)
            pybullet.setPhysicsEngineParameter(fixedTimeStep=dt, numSubSteps=0, **here)
            with tempfile.NamedTemporaryFile(suffix=".vtk") as file:
                write_vtk(block, file.name)
                self.body = pybullet.loadSoftBody(
                    file.name,
                    simFileName=file.name,
                    scale=1.0,
                    mass=float(block.masses().sum()),
                    useNeoHookean=1,
                    NeoHookeanMu=4 / 3 * block.mu,  # so that small strains obey Hooke's law
                    NeoHookeanLambda=block.lam + 5 / 6 * block.mu,
                    NeoHookeanDamping=damping,
                    springElasticStiffness=0,
                    collisionMargin=0.001,
                    **here,
                )
            for node in np.flatnonzero(block.pinned):
                pybullet.createSoftBodyAnchor(self.body, int(node), -1, -1, **here)

    def step(self):
        self._bullet.stepSimulation(physicsClientId=self._client)

    def nodes(self):
        flags = self._bullet.MESH_DATA_SIMULATION_MESH
        return np.array(self._bullet.getMeshData(self.body, -1, flags=flags, physicsClientId=self._client)[1])

    def __del__(self):
        with contextlib.suppress(Exception):
            self._bullet.disconnect(self._client)

    @staticmethod
    def version():
        import importlib.metadata

        return importlib.metadata.version("pybullet")


class Newton:
    """On the processor. `scheme` "VBD": block descent of 10 iterations, its default; "explicit": SolverSemiImplicit.

    A step is recorded once and launched as a graph, which makes it twice as fast.
    """

    package, equal = "newton", False
    cannot = (
        "no second thread on the processor; no rest with the damping of the others; no volumetric bodies in other "
        "solvers, says its example"
    )

    def __init__(self, block, dt, damping=0.0, scheme="VBD", copies=1):
        import newton
        import warp

        warp.config.quiet = True
        vbd = scheme == "VBD"
        self.law = "neo-Hookean" if vbd else "neo-Hookean, log"
        mu, lam = (block.mu, block.lam) if vbd else (4 / 3 * block.mu, block.lam + 5 / 6 * block.mu)
        builder = newton.ModelBuilder(up_axis=newton.Axis.Y, gravity=(0.0, -9.81, 0.0))
        for _ in range(copies):
            self._add(newton, warp, builder, block, mu, lam, damping * mu * (0.5 if vbd else 1))
        if vbd:
            builder.color()
        model = builder.finalize(device="cpu")
        options = {"iterations": 10, "particle_enable_tile_solve": False} if vbd else {}
        solver = (newton.solvers.SolverVBD if vbd else newton.solvers.SolverSemiImplicit)(model=model, **options)
        self._states, self._control, self._count = [model.state(), model.state()], model.control(), len(block.nodes)

        def act(i):
            self._states[i].clear_forces()
            solver.step(self._states[i], self._states[1 - i], self._control, None, dt)

        self._now, self._graphs, self._warp, self._act = 0, [], warp, act

    @staticmethod
    def _add(newton, warp, builder, block, mu, lam, damping):
        first = len(builder.particle_mass)
        builder.add_soft_mesh(
            pos=warp.vec3(0.0, 0.0, 0.0),
            rot=warp.quat_identity(),
            scale=1.0,
            vel=warp.vec3(0.0, 0.0, 0.0),
            vertices=[warp.vec3(*each) for each in block.nodes],
            indices=block.tetrahedra.ravel().tolist(),
            density=block.density,
            k_mu=mu,
            k_lambda=lam,
            k_damp=damping,
            add_surface_mesh_edges=False,
            particle_radius=0.001,
        )
        for node in first + np.flatnonzero(block.pinned):
            builder.particle_mass[node] = 0.0
            builder.particle_flags[node] = int(builder.particle_flags[node]) & ~int(newton.ParticleFlags.ACTIVE)

    def step(self):
        if len(self._graphs) < 2:  # the first two steps compile and record
            self._act(self._now)
            state = self._states[1 - self._now]
            kept = [state.particle_q.numpy().copy(), state.particle_qd.numpy().copy()]
            with self._warp.ScopedCapture(device="cpu") as capture:
                self._act(self._now)
            state.particle_q.assign(kept[0])
            state.particle_qd.assign(kept[1])
            self._graphs.append(capture.graph)
        else:
            self._warp.capture_launch(self._graphs[self._now])
        self._now = 1 - self._now

    def nodes(self):
        return self._states[self._now].particle_q.numpy()[: self._count].astype(float)

    @staticmethod
    def version():
        import newton
        import warp

        return f"{newton.__version__}, Warp {warp.config.version}"
