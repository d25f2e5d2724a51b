"""Files. Millimetres come in, metres go out, rounded to 10 nm: the same text on every machine that rounds alike."""
import json

import numpy as np


def metre(x):
    text = "%.8f" % (x / 1000.0)
    text = text.rstrip("0").rstrip(".")
    return "0" if text in ("-0", "") else text


def metres(values):
    """Numbers for JSON."""
    return [float(metre(x)) for x in np.ravel(values)]


def write_msh(path, nodes, tets):
    """Gmsh 2.2 ASCII, like the meshes beside it."""
    rows = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$Nodes", str(len(nodes))]
    rows += [f"{i + 1} {metre(p[0])} {metre(p[1])} {metre(p[2])}" for i, p in enumerate(nodes)]
    rows += ["$EndNodes", "$Elements", str(len(tets))]
    rows += ["%d 4 2 0 1 %d %d %d %d" % (i + 1, *(t + 1)) for i, t in enumerate(tets)]
    path.write_text("\n".join(rows + ["$EndElements", ""]))


def write_obj(path, v, faces, uv=None, note=""):
    rows = [f"# {note or path.stem}; metres; made by assets/pipeline"]
    rows += [f"v {metre(p[0])} {metre(p[1])} {metre(p[2])}" for p in v]
    if uv is not None:
        rows += ["vt %.4f %.4f" % tuple(c) for c in uv]
        rows += ["f " + " ".join(f"{a}/{a}" for a in t + 1) for t in faces]
    else:
        rows += ["f %d %d %d" % tuple(t + 1) for t in faces]
    path.write_text("\n".join(rows + [""]))


def write_json(path, value):
    """One line per entry of every long list, so that changes can be read."""
    def entry(x):
        return json.dumps(x, separators=(", ", ": "))
    rows = []
    for key, x in value.items():
        if isinstance(x, list) and x and isinstance(x[0], (dict, list)):
            rows.append(f'"{key}": [\n' + ",\n".join("    " + entry(e) for e in x) + "\n  ]")
        elif isinstance(x, dict) and any(isinstance(e, (dict, list)) for e in x.values()):
            rows.append(f'"{key}": {{\n' + ",\n".join(f'    "{k}": ' + entry(e) for k, e in x.items()) + "\n  }")
        else:
            rows.append(f'"{key}": ' + entry(x))
    path.write_text("{\n  " + ",\n  ".join(rows) + "\n}\n")
