"""Tissue hangs, swings and is pushed: python -m filasofia.demo. Its picture too, where OpenGL is installed."""

from __future__ import annotations

import argparse
import os
import sys

import filasofia as fs


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m filasofia.demo", description="Tissue hangs, swings and is pushed.")
    parser.add_argument("--picture", default="filasofia_demo.png", help="file of the picture (default: %(default)s)")
    file = parser.parse_args().picture
    folder = os.path.dirname(file) or "."
    if not file.lower().endswith(".png") or not os.path.isdir(folder):  # before the run, not after it
        parser.error(f"--picture must be a .png in a folder that exists, got {file!r}")

    around = fs.Box((-0.1, -0.05, -0.05), (0.06, 0.15, 0.08))
    sim = fs.Simulation(rate=1000, look=fs.LookDef(around=around, direction=(0.8, 0.3, 1)))
    bunny = sim.add(
        fs.SoftBodyDef(
            name="bunny",
            mesh=fs.asset("meshes/bunny_3004.msh"),
            material=fs.FemMaterial(young_modulus=10e3, poisson_ratio=0.45),
            attachments=[fs.AttachmentDef(box=fs.Box((-1, 0.105, -1), (1, 1, 1)))],
            collision=[fs.CollisionDef()],
        )
    )
    ball = sim.add(
        fs.RigidBodyDef(
            name="ball", elements=[(-0.01, 0.02, 0.13)], mesh=fs.shapes.sphere(0.015), collision=[fs.CollisionDef()]
        )
    )
    sim.show(bunny, surface=fs.asset("meshes/bunny.obj"), subdivision=1)
    sim.show(ball, material=fs.MetalMaterial())
    sim.every_step(lambda time: sim.set_pose(ball, (-0.01, 0.02, max(0.06, 0.13 - 0.15 * time))))
    report = sim.run(0.8)
    lowest = sim.frame[bunny].positions[:, 1].min()
    force = max((pair.max_normal_force for pair in report.contacts), default=0.0)
    print(f"{report.steps} steps of {len(sim.frame[bunny].positions)} nodes in {report.wall_seconds:.2f} s")
    print(f"the bunny swings at {lowest * 1e3:.1f} mm, and the ball has pushed it with up to {force:.2f} N")
    try:
        sim.render(960, 720).save(file)
        print(f"wrote {file}")
    except fs.Error as problem:  # no OpenGL
        print(f"no picture: {problem}")
    except OSError as problem:
        print(f"no picture: {file}: {problem.strerror}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
