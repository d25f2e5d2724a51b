"""Small scenes that several tests use."""
import filasofia as fs


def bunny():
    """README's: pinned at the head."""
    return fs.SoftBodyDef(
        name="bunny",
        mesh=fs.asset("meshes/bunny_3004.msh"),
        material=fs.FemMaterial(young_modulus=10e3, poisson_ratio=0.45),
        attachments=[fs.AttachmentDef(box=fs.Box((-1, 0.105, -1), (1, 1, 1)))],
    )


def block(**fields):
    """A block of tissue, 6 cm wide, pinned at its bottom."""
    given = dict(
        name="block",
        mesh=fs.shapes.block((0.06, 0.03, 0.06), (5, 3, 5)),
        attachments=[fs.AttachmentDef(box=fs.Box((-1, -1, -1), (1, -0.0149, 1)))],
        collision=[fs.CollisionDef()],
    )
    return fs.SoftBodyDef(**{**given, **fields})


def ball(**fields):
    """A kinematic ball of 8 mm, 2 mm above the block."""
    given = dict(name="ball", elements=[(0, 0.025, 0)], mesh=fs.shapes.sphere(0.008), collision=[fs.CollisionDef()])
    return fs.RigidBodyDef(**{**given, **fields})


def poke(threads=1, **fields):
    """The two of them; the ball can be pressed into the block."""
    sim = fs.Simulation(threads=threads, **fields)
    return sim, sim.add(block()), sim.add(ball())
