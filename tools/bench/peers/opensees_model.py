"""Builds and runs a case in OpenSees: opensees_model.py CASE.npz ANSWER.npy.

Runs in a Python that has openseespy. Linear cases factor once; joints take Newton's method.
"""

import sys

import numpy as np
import openseespy.opensees as ops


def build(case):
    """Nodes, bricks, contacts."""
    ops.model("basic", "-ndm", 3, "-ndf", 3)
    for number, point in enumerate(case["x"].tolist(), start=1):
        ops.node(number, *point)
    for node in case["fixed"].tolist():
        ops.fix(node + 1, 1, 1, 1)
    modulus, poisson, density = case["concrete"].tolist()
    ops.nDMaterial("ElasticIsotropic", 1, modulus, poisson, density)
    ops.nDMaterial("ElasticIsotropic", 2, *case["ground"].tolist(), 0.0)
    element = 0
    for bricks, material in ((case["dam"], 1), (case["rock"], 2)):
        for nodes in (bricks + 1).tolist():
            element += 1
            ops.element("stdBrick", element, *nodes, material)
    normal_stiffness, shear_stiffness, friction = case["joint"].tolist()
    columns = (case["master"], case["slave"], case["area"], case["normal"])
    for master, slave, area, normal in zip(*(c.tolist() for c in columns), strict=True):
        element += 1
        stiffness = (normal_stiffness * area, shear_stiffness * area, friction)
        ops.element(
            "zeroLengthContactASDimplex",
            element,
            *(master + 1, slave + 1),
            *stiffness,
            "-orient",
            *normal,
            "-intType",
            0,
        )


def add_weight(case):
    """Nodal forces of the weight: the mass of each corner of the bricks by the rule 2 x 2 x 2."""
    force = np.zeros(len(case["x"]))
    share = case["gravity"] * case["concrete"][2]
    side = 1.0 / np.sqrt(3.0)
    around = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
    corner = np.array([(*xy, z) for z in (-1, 1) for xy in around])
    x = case["x"][case["dam"]]
    for point in side * corner:
        factor = 1.0 + corner * point
        shape = factor.prod(axis=1) / 8.0
        slope = np.stack(
            [corner[:, i] * factor[:, (i + 1) % 3] * factor[:, (i + 2) % 3] / 8.0 for i in range(3)]
        )
        volume = np.linalg.det(slope @ x)
        np.add.at(force, case["dam"], share * volume[:, None] * shape)
    ops.timeSeries("Linear", 1)
    ops.pattern("Plain", 1, 1)
    for node in np.flatnonzero(force).tolist():
        ops.load(node + 1, 0.0, 0.0, -force[node])


def choose_solver(is_linear):
    """MUMPS; one factorisation where the model is linear."""
    ops.constraints("Plain")
    ops.numberer("AMD")
    ops.system("Mumps")
    ops.test("NormUnbalance", 1.0e3, 25, 0)
    ops.algorithm(*(("Linear", "-factorOnce") if is_linear else ("Newton",)))


def main(case_file, answer_file):
    case = np.load(case_file)
    control, dt, motion = int(case["control"]) + 1, float(case["increment"]), case["motion"]
    is_linear = len(case["master"]) == 0
    rows, code = [], 0
    build(case)
    if case["gravity"] > 0.0:
        add_weight(case)
        choose_solver(is_linear)
        ops.integrator("LoadControl", 1.0)
        ops.analysis("Static")
        code = ops.analyze(1)
        rows = [ops.nodeDisp(control)]
        ops.loadConst("-time", 0.0)
    if len(motion) > 0 and code == 0:
        rows = []
        ops.wipeAnalysis()
        ops.timeSeries("Path", 2, "-dt", dt, "-values", *motion.tolist())
        ops.pattern("UniformExcitation", 2, 1, "-accel", 2)
        choose_solver(is_linear)
        ops.integrator("HHT", 1.0 + float(case["alpha"]))
        ops.analysis("Transient")
        for _ in range(len(motion) - 1):
            code = ops.analyze(1, dt)
            if code:
                break
            rows.append(ops.nodeDisp(control))
            np.save(answer_file, np.array(rows).reshape(-1, 3))  # what there is when it is stopped
    np.save(answer_file, np.array(rows).reshape(-1, 3))
    return 0 if code == 0 else 1


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
