#!/usr/bin/env python3
"""Run GetFEM on the block of ../calculix at Poisson's ratios up to 0.4999, and with Gent's law: NAME.csv. Usage: regenerate.py (with python3-getfem)"""
from pathlib import Path

import getfem
import numpy

HERE = Path(__file__).parent
SHEAR = 1e4  # [Pa]
LOAD_STEPS = 20


def deck(file):
    """Nodes, tetrahedra with indices from 0, held nodes and nodal forces of a deck that ../calculix/regenerate.py wrote."""
    nodes, tetrahedra, held, forces, keyword = [], [], [], [], ""
    for line in file.read_text().splitlines():
        if line.startswith("*"):
            keyword = line.split(",")[0]
            continue
        row = line.split(",")
        if keyword == "*NODE":
            nodes.append([float(x) for x in row[1:]])
        elif keyword == "*ELEMENT":
            tetrahedra.append([int(i) - 1 for i in row[1:]])
        elif keyword == "*BOUNDARY":
            held.append(int(row[0]) - 1)
        elif keyword == "*CLOAD":
            forces.append((int(row[0]) - 1, int(row[1]) - 1, float(row[2])))
    return numpy.array(nodes), tetrahedra, held, forces


def lame(nu):
    return 2 * SHEAR * nu / (1 - 2 * nu)


class Block:
    def __init__(self, order):
        self.nodes, tetrahedra, held, self.forces = deck(HERE / "../calculix/neo_hooke_block.inp")
        self.mesh = getfem.Mesh("empty", 3)
        transform = getfem.GeoTrans("GT_PK(3,1)")
        for t in tetrahedra:
            self.mesh.add_convex(transform, self.nodes[t].T)
        clamped = self.mesh.outer_faces_with_direction([-1, 0, 0], 1e-3)
        self.mesh.set_region(1, clamped)
        assert len(held) == numpy.sum(self.nodes[:, 0] == 0)
        self.u = getfem.MeshFem(self.mesh, 3)
        self.u.set_fem(getfem.Fem(f"FEM_PK(3,{order})"))
        self.p = getfem.MeshFem(self.mesh, 1)
        self.p.set_fem(getfem.Fem("FEM_PK(3,1)"))
        places = self.u.basic_dof_nodes().T
        self.first = [int(numpy.argmin(numpy.linalg.norm(places - node, axis=1))) for node in self.nodes]

    def integration(self, method):
        return getfem.MeshIm(self.mesh, getfem.Integ(method))

    def model(self, terms, pressure):
        """`terms`: integration methods and energies per volume."""
        model = getfem.Model("real")
        model.add_fem_variable("u", self.u)
        if pressure:
            model.add_fem_variable("p", self.p)
        for method, energy in terms:
            energy = energy.replace("F", "(Id(3)+Grad_u)")
            model.add_nonlinear_term(self.integration(method), energy)
        model.add_Dirichlet_condition_with_simplification("u", 1)
        load = numpy.zeros(self.u.nbdof())
        for node, axis, force in self.forces:
            load[self.first[node] // 3 * 3 + axis] += force
        index = model.add_explicit_rhs("u", load)
        for i in range(1, LOAD_STEPS + 1):
            model.set_private_rhs(index, load * i / LOAD_STEPS)
            iterations, converged = model.solve("max_res", 1e-9, "max_iter", 60)
            assert converged, f"load step {i}: {iterations} iterations"
        found = model.variable("u")
        return numpy.array([[found[first // 3 * 3 + axis] for axis in range(3)] for first in self.first])


def energy_of_shape(own):
    """Neo-Hookean (Bonet and Wood 2008) with this lambda."""
    return f"{SHEAR}/2*(Norm_sqr(F)-3)-{SHEAR}*log(Det(F))+{own}/2*sqr(Det(F)-1)"


def linear(nu):
    """Linear tetrahedra. Beyond 0.45 the element keeps lambda of 0.3, and a pressure with nodal quadrature has the rest:
    the average nodal pressure of Bonet and Burton (1998), as a mixed formulation."""
    if nu <= 0.45:
        return Block(1).model([("IM_TETRAHEDRON(1)", energy_of_shape(lame(nu)))], False)
    own = lame(0.3)
    return Block(1).model([("IM_TETRAHEDRON(1)", energy_of_shape(own)), ("IM_TETRAHEDRON(1)", "p*(Det(F)-1)"),
                           ("IM_NC(3,1)", f"-p*p/{2 * (lame(nu) - own)}")], True)


def taylor_hood(nu):
    """Quadratic displacements and linear pressures for all of lambda but that of 0.3, on the same tetrahedra."""
    own = lame(0.3)
    return Block(2).model([("IM_TETRAHEDRON(5)", energy_of_shape(own)),
                           ("IM_TETRAHEDRON(5)", f"p*(Det(F)-1)-p*p/{2 * (lame(nu) - own)}")], True)


def gent(nu, limit):
    """Gent (1996) with the change of volume apart, on linear tetrahedra."""
    shape = f"-{SHEAR * limit / 2}*log(1-(Norm_sqr(F)*pow(Det(F),-2/3)-3)/{limit})"
    bulk = lame(nu) + 2 / 3 * SHEAR
    return Block(1).model([("IM_TETRAHEDRON(1)", f"{shape}+{bulk / 2}*sqr(Det(F)-1)")], False)


def write(name, displacements):
    rows = ["%d,%.9e,%.9e,%.9e" % (i, *u) for i, u in enumerate(displacements, 1)]
    (HERE / f"{name}.csv").write_text("\n".join(["node,ux,uy,uz"] + rows) + "\n")
    print(name, "largest displacement", numpy.linalg.norm(displacements, axis=1).max(), "m")


getfem.util_trace_level(0)
for nu in (0.45, 0.49, 0.499, 0.4999):
    write(f"linear_{nu}", linear(nu))
write("taylor_hood_0.4999", taylor_hood(0.4999))
for limit in (0.1, 2):
    write(f"gent_{limit}", gent(0.4, limit))
