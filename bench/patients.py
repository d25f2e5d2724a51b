"""From an image to an organ that moves: twenty inputs, and anatomies at random.

    python bench/patients.py                       (the package with [anatomy]: twenty inputs, 10,000 tetrahedra each)
    python bench/patients.py --random 1000         (anatomies of seeds 0 to 999, 2,000 to 30,000 tetrahedra each)

Each input is written as a file, read, meshed, written as a scene, loaded and stepped a thousand times; a ball is pressed
into its largest organ, 10 mm deep or less, and drawn back. "time" is from the file to the first step. Volumes are compared
with those of the input; Hausdorff and mean distances are between the mesh and the surface of the input. "round trip" is
whether the regions of the written mesh are read back exactly, "left" how far from where they began organs end.
"""

import argparse
import json
import os
import tempfile
import time

import numpy as np

import filasofia as fs
from filasofia import anatomy
from filasofia.anatomy import phantoms as ph


def turned(map_):
    """The same voxels in a frame that no axis of the world is along."""
    turn = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]
    affine = map_.affine.copy()
    affine[:3] = turn @ affine[:3]
    return anatomy.LabelMap(map_.array, affine, names=map_.names)


def maps():
    low, high = (-0.06, -0.06, -0.06), (0.06, 0.06, 0.06)
    ball = ph.ellipsoid((0, 0, 0), (0.05, 0.04, 0.03))
    half = lambda sign: ph.both(ball, lambda p: sign * p[..., 0])  # noqa: E731
    yield "ellipsoid", ph.label_map({"liver": ball}, low, high, 1.5e-3)
    yield "liver, gallbladder, vein, bone", ph.liver_and_gallbladder()
    yield "17 organs of an abdomen", ph.abdomen()
    yield "vessel like a Y", ph.vessel()
    yield "two halves that touch", ph.label_map({"liver": half(1.0), "spleen": half(-1.0)}, low, high, 1.5e-3)
    yield "sheet of 4 mm", ph.label_map({"muscle": ph.ellipsoid((0, 0, 0), (0.05, 0.05, 0.002))}, low, high, 0.7e-3)
    wall = ph.without(ph.ellipsoid((0, 0, 0), (0.03, 0.03, 0.05)), ph.ellipsoid((0, 0, 0.005), (0.01, 0.016, 0.03)))
    yield "hollow wall", ph.label_map({"uterus": wall}, low, high, 1e-3)
    pair = ph.union(ph.ellipsoid((-0.035, 0, 0), (0.02, 0.02, 0.04)), ph.ellipsoid((0.035, 0, 0), (0.02, 0.02, 0.04)))
    yield "one label, two pieces", ph.label_map({"kidney": pair}, low, high, 1.5e-3)
    yield "voxels of 0.8 x 0.8 x 5 mm", ph.label_map({"liver": ball}, low, high, (0.8e-3, 0.8e-3, 5e-3))
    yield "noise of half a voxel", ph.label_map({"liver": ball, "kidney": ph.ellipsoid((0.04, 0, 0), (0.02, 0.02, 0.02))}, low, high, 1.5e-3, 0.75e-3)
    yield "oblique voxels", turned(ph.liver_and_gallbladder())
    ring = lambda p: np.hypot(np.hypot(p[..., 0], p[..., 1]) - 0.035, p[..., 2]) - 0.012  # noqa: E731
    yield "ring", ph.label_map({"colon": ring}, low, high, 1e-3)
    yield "coarse: 9 voxels across", ph.label_map({"liver": ball}, low, high, 11e-3)


def surfaces(folder):
    """Broken ones too."""
    bunny = fs.load_triangle_mesh(fs.asset("meshes/bunny.obj"))
    v, f = np.array(bunny.vertices), np.array(bunny.triangles)
    middle = v[f].mean(axis=1)
    random = np.random.default_rng(0)
    holed = f[np.linalg.norm(middle - middle[100], axis=1) > 0.012]
    mixed = np.where(random.random(len(f))[:, None] < 0.1, f[:, ::-1], f)
    yield "surface", v, f
    yield "surface with a hole, in mm, 10 % flipped", 1e3 * v, mixed[np.linalg.norm(middle - middle[100], axis=1) > 0.012]
    yield "surface through itself", np.concatenate([v, v + [0.02, 0, 0]]), np.concatenate([f, f + len(v)])
    fin = np.array([[f[0, 0], f[0, 1], len(v)]])
    yield "surface with a fin and noise", np.concatenate([v + random.normal(size=v.shape) * 3e-4, v[f[:1, 0]] + [0, 0.02, 0]]), np.concatenate([f, fin])
    yield "loose triangles of a surface with a hole", v[holed].reshape(-1, 3), np.arange(3 * len(holed)).reshape(-1, 3)


def files(folder):
    """Name and file of every input."""
    for name, map_ in maps():
        file = os.path.join(folder, f"{len(os.listdir(folder))}.nii.gz")
        anatomy.write_labels(map_, file)
        yield name, file, {i: n for i, n in map_.names.items()}, 10_000
    for name, v, f in surfaces(folder):
        file = os.path.join(folder, f"bunny{len(os.listdir(folder))}.obj")
        anatomy.write_obj(file, (v, f))
        yield name, file, None, 10_000
    yield "tetrahedra, as they are", fs.asset("meshes/bunny_10000.msh"), None, None
    yield "tetrahedra, meshed again", fs.asset("meshes/hysteroscopy/uterus_5000.msh"), None, 10_000


def one(name, file, names, tetrahedra, folder, steps, separate=False):
    begin, worked = time.perf_counter(), time.process_time()
    made, _ = anatomy.anatomy_of([file], tetrahedra, names=names)
    scene = os.path.join(folder, "scene.json")
    anatomy.write_scene(made, scene, overwrite=True, separate=separate)
    with fs.load(scene, threads=2) as sim:
        sim.step()
        soft = [body for body in sim.bodies if hasattr(sim.frame[body], "positions")]
        rest = {body: sim.frame[body].positions.copy() for body in soft}
        largest = max(soft, key=lambda body: len(rest[body]))
        top = rest[largest][rest[largest][:, 1].argmax()]
        depth = min(0.01, 0.2 * float(np.ptp(rest[largest][:, 1])))
        sim.remove(sim.bodies[-1])  # the scene's probe
        ball = sim.add(fs.RigidBodyDef(name="ball", elements=[top + [0, 0.009, 0]], mesh=fs.shapes.sphere(0.008), collision=[fs.CollisionDef()]))
        seconds, worked = time.perf_counter() - begin, time.process_time() - worked
        sim.step()
        begin = time.perf_counter()
        sim.step(int(0.3 * steps), moves={ball: top + [0, 0.008 - depth, 0]})
        moved = max(float(np.linalg.norm(sim.frame[body].positions - rest[body], axis=1).max()) for body in soft)
        sim.step(int(0.2 * steps), moves={ball: top + [0, 0.03, 0]})
        sim.step(steps - 3 - int(0.3 * steps) - int(0.2 * steps))
        rate = (steps - 3) / (time.perf_counter() - begin)
        report = sim.report()
        left = max(float(np.linalg.norm(sim.frame[body].positions - rest[body], axis=1).max()) for body in soft)
        finite = all(np.isfinite(sim.frame[body].positions).all() for body in soft)
    mesh = os.path.join(folder, "mesh.msh")
    anatomy.write_msh(mesh, made.nodes, made.tetrahedra, made.labels, made.names)
    back = fs.load_tet_mesh(mesh)
    same = np.array_equal(back.labels, made.labels) and np.array_equal(back.nodes, made.nodes) and np.array_equal(back.tetrahedra, made.tetrahedra)
    organs = [made.quality(organ) for organ in made.names.values()]
    return {
        "input": name, "organs": len(organs), "tetrahedra": len(made.tetrahedra), "seconds": seconds, "processor_seconds": worked, "steps_per_second": rate,
        "volume_error": max((abs(q.volume / q.wanted_volume - 1) for q in organs)), "size": made.size,
        "hausdorff": max(q.hausdorff for q in organs), "mean": max(q.mean_distance for q in organs),
        "least_angle": min(q.least_angle for q in organs), "largest_angle": max(q.largest_angle for q in organs),
        "round_trip": bool(same), "finite": bool(finite), "undone": report.undone, "inverted": report.inverted, "moved": moved, "left": left, "notes": made.notes,
    }  # fmt: skip


def twenty(steps, separate):
    rows = []
    print("| input | organs | tetrahedra | time [s] | processor [s] | volume off | Hausdorff [mm] | mean [mm] | element [mm] | angles [deg] | round trip | inverted, undone | steps/s | moved, left |")
    print("|---|---|---|---|---|---|---|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        for name, file, names, tetrahedra in files(folder):
            row = one(name, file, names, tetrahedra, folder, steps, separate)
            rows.append(row)
            print(
                f"| {name} | {row['organs']} | {row['tetrahedra']} | {row['seconds']:.1f} | {row['processor_seconds']:.1f} | {100 * row['volume_error']:.2f} % | {1e3 * row['hausdorff']:.2f} |"
                f" {1e3 * row['mean']:.2f} | {1e3 * row['size']:.1f} | {row['least_angle']:.1f} to {row['largest_angle']:.1f} |"
                f" {'exact' if row['round_trip'] else 'NO'} | {row['inverted']}, {row['undone']} | {row['steps_per_second']:.0f} |"
                f" {1e3 * row['moved']:.1f}, {1e3 * row['left']:.2f} |",
                flush=True,
            )
    return rows


def at_random(first, count):
    """Each seed: a mesh that the engine accepts, with no angle below 10 degrees and volumes within 1 %, or what was said."""
    fine, said, far = 0, [], []
    for seed in range(first, first + count):
        map_ = ph.random_anatomy(seed)
        if seed > first and (seed - first) % 25 == 0:
            print(f"{fine} of {seed - first}", flush=True)
        try:
            made = anatomy.mesh_labels(map_, size=anatomy.fitting_size(map_, 2000, 30_000))
            made.mesh()
            organs = [made.quality(name) for name in made.names.values()]
            least, off = min(q.least_angle for q in organs), max(abs(q.volume / q.wanted_volume - 1) for q in organs)
            far.append(max(q.hausdorff for q in organs) / made.size)
            if least >= 10.0 and off <= 0.01:
                fine += 1
                continue
            said.append((seed, f"smallest angle {least:.1f} degrees, volume off by {100 * off:.2f} %"))
        except fs.Error as problem:
            said.append((seed, str(problem)))
        print(*said[-1], flush=True)
    shares = np.percentile(far, (50, 95, 100)).tolist()
    print(f"{fine} of {count} untouched; Hausdorff distance / element size: median {shares[0]:.2f}, 95 % {shares[1]:.2f}, largest {shares[2]:.2f}")
    return {"seeds": [first, first + count], "fine": fine, "others": said, "hausdorff": shares}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--random", type=int, default=0, help="so many anatomies at random, in place of the twenty inputs")
    parser.add_argument("--first", type=int, default=0, help="their first seed (default: 0)")
    parser.add_argument("--steps", type=int, default=1000, help="steps of each scene (default: 1000)")
    parser.add_argument("--separate", action="store_true", help="each organ is a body of its own")
    parser.add_argument("--json", help="file of the results")
    words = parser.parse_args()
    rows = at_random(words.first, words.random) if words.random else twenty(words.steps, words.separate)
    if words.json:
        with open(words.json, "w") as stream:
            json.dump(rows, stream, indent=1)


if __name__ == "__main__":
    main()
