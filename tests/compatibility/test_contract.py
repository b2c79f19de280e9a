"""Each row of the table of keywords of other programs in docs/deck.md: decks with small changes."""

import pytest
from harness import ROOT

BASES = {
    name: (ROOT / "tests/errors/base" / f"{name}.inp").read_text() for name in ("block", "surfaces")
}
LAW, PAIR = (
    "*SURFACE INTERACTION, NAME=ROCK\n",
    "*CONTACT PAIR, INTERACTION=ROCK, SMALL SLIDING\nUPPER, LOWER\n",
)
JOINT = (
    "*JOINT LAW, NAME=CONTRACTION, FRICTION=0.6\n*JOINT, NAME=J1, LAW=CONTRACTION\nUPPER, LOWER\n"
)
SOLID = "*SOLID SECTION, ELSET=DAM, MATERIAL=CONCRETE\n"
GRAVITY = "DAM, GRAV, 9.81, 0., 0., -1."


def changed(base: str, edits: dict[str, str]) -> str:
    text = BASES[base]
    for old, new in edits.items():
        assert old in text, old
        text = text.replace(old, new, 1)
    return text


def pair(law: str, options: str = "") -> dict[str, str]:
    """A contact pair with this law in place of the joint, and a block whose weight closes it."""
    return {
        JOINT: LAW + law + PAIR.replace("SMALL SLIDING", "SMALL SLIDING" + options),
        "BASE, 1, 3": "BASE, 1, 3\n15, 1, 2\n16, 2",
        GRAVITY: GRAVITY + GRAVITY.replace("DAM", "\nBLOCK"),
    }


def above(old: str, new: str) -> dict[str, str]:
    return {old: new + old}


READ = [
    (
        "boundary, empty last dof",
        "block",
        {"BASE, 1, 3": "BASE, 1, 3\n9,1,,0", "8, 0., 1., 1.\n": "8, 0., 1., 1.\n9, 5., 5., 5.\n"},
    ),
    ("boundary, one dof", "block", {"BASE, 1, 3": "BASE, 1\nBASE, 2\nBASE, 3"}),
    ("boundary, encastre", "block", {"BASE, 1, 3": "BASE, ENCASTRE"}),
    ("boundary, pinned", "block", {"BASE, 1, 3": "BASE, Pinned"}),
    ("boundary, symmetry", "block", {"BASE, 1, 3": "BASE, XSYMM\nBASE, YSYMM\nBASE, ZSYMM"}),
    ("boundary, antisymmetry", "block", {"BASE, 1, 3": "BASE, XASYMM\nBASE, ZASYMM"}),
    ("static, no first increment", "block", {"*STATIC": "*STATIC\n, 1., , 0.5"}),
    ("nodes, rectangular coordinates", "block", {"*NODE, ": "*NODE, SYSTEM=R, "}),
    (
        "boundary, a set of such a name",
        "block",
        {"NSET=BASE": "NSET=ENCASTRE", "BASE, 1, 3": "ENCASTRE, ENCASTRE"},
    ),
    ("boundary, rotations", "block", {"BASE, 1, 3": "BASE, 1, 6, 0."}),
    (
        "equations",
        "block",
        above(
            "*BOUNDARY", "*EQUATION\n2\n5, 1, 1., 6, 1, -1.\n3\n5, 2, 1., 6, 2, -1.,\n7, 2, 1.\n"
        ),
    ),
    ("hard contact", "surfaces", pair("*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=HARD\n")),
    ("linear contact", "surfaces", pair("*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n1e12\n")),
    ("tied contact", "surfaces", pair("*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=TIED\n1e12\n")),
    ("friction", "surfaces", pair("*FRICTION\n0.6\n")),
    (
        "friction, stick slope",
        "surfaces",
        pair("*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n1e12\n*FRICTION\n0.6, 1e11\n"),
    ),
    ("plastic", "block", above("*SOLID", "*PLASTIC\n3e8, 0.\n4e8, 0.1\n")),
    (
        "expansion",
        "block",
        {
            **above("*SOLID", "*EXPANSION\n1e-5\n"),
            "*STEP\n": "*INITIAL CONDITIONS, TYPE=TEMPERATURE\nALL, 20.\n*STEP\n",
            "*DLOAD": "*TEMPERATURE\nALL, 30.\n*DLOAD",
        },
    ),
    ("small strains", "block", {"*STEP": "*STEP, NLGEOM=NO, INC=50\nthe weight of the dam"}),
    (
        "modes",
        "block",
        {
            "*STEP\n*STATIC\n": "*STEP, PERTURBATION\n*FREQUENCY\n2\n",
            "*DLOAD\n" + GRAVITY + "\n": "",
        },
    ),
    ("static, empty fields", "block", {"*STATIC": "*STATIC, SOLVER=PARDISO\n0.5, , , 1."}),
    (
        "dynamic, solver",
        "block",
        {"*STATIC": "*DYNAMIC, SOLVER=SPOOLES, ALPHA=-0.05\n0.1, 0.2, , "},
    ),
    ("section with an empty line", "block", {SOLID: SOLID + ",\n"}),
    ("section with a thickness", "block", {SOLID: SOLID + "1.,\n"}),
    (
        "blanks in a keyword",
        "block",
        {"*NODE, ": "* Node, ", "*END STEP": "*EL FILE\nS\n*ELFILE\nE\n*NODEFILE\nU\n*endstep"},
    ),
    ("a comma after the keyword", "block", {"*ELASTIC": "*ELASTIC,"}),
    ("comments inside data", "block", {"2, 1., 0., 0.\n": "2, 1., 0., 0.\n** corner\n\n\t\n"}),
    ("indented keywords", "block", {"*BOUNDARY": "   *BOUNDARY", "*STATIC": "\t*STATIC"}),
    ("no newline at the end", "block", {"*END STEP\n": "*END STEP"}),
    ("carriage returns", "block", {"*MATERIAL, NAME=CONCRETE\n": "*MATERIAL, NAME=CONCRETE\r\n"}),
    (
        "quoted names",
        "block",
        {"NAME=CONCRETE": 'NAME="Dam concrete"', "MATERIAL=CONCRETE": 'MATERIAL="Dam concrete"'},
    ),
    (
        "names with signs",
        "block",
        {"NSET=BASE": "NSET=1-base.(a)", "BASE, 1, 3": "1-BASE.(A), 1, 3"},
    ),
    ("a set and a surface of one name", "block", {"NAME=UPSTREAM": "NAME=DAM"}),
    ("two coordinates", "block", {"1, 0., 0., 0.": "1, 0., 0."}),
    (
        "unsorted and unused nodes",
        "block",
        {"1, 0., 0., 0.\n": "900001, 4., 4., 4.\n1, 0., 0., 0.\n"},
    ),
    (
        "amplitudes",
        "block",
        {
            "*STEP": "*AMPLITUDE, NAME=A\n0., 0., 0.5, 0.5, 1., 1.\n"
            "*AMPLITUDE, NAME=B\n0., 0.\n1., 1.\n*STEP",
            "*DLOAD": "*DLOAD, AMPLITUDE=A",
        },
    ),
    (
        "model keywords inside a step",
        "block",
        {"*DLOAD": "*NSET, NSET=LATE\n5, 6\n*ELSET, ELSET=LATER\n1\n*DLOAD"},
    ),
]
REFUSED = [
    ("rotation", "block", {"BASE, 1, 3": "BASE, 1, 3\nBASE, 4, 4, 0.1"}, "*BOUNDARY: "),
    ("removed equations", "block", above("*DLOAD", "*EQUATION, REMOVE\n"), "*EQUATION"),
    (
        "a dependent dof twice",
        "block",
        above("*BOUNDARY", "*EQUATION\n2\n5, 1, 1., 6, 1, -1.\n2\n5, 1, 1., 7, 1, -1.\n"),
        "*EQUATION: ",
    ),
    ("mortar", "surfaces", pair("", ", TYPE=MORTAR"), "*CONTACT PAIR: TYPE: found 'MORTAR'"),
    ("massless", "surfaces", pair("", ", TYPE=MASSLESS"), "*CONTACT PAIR: TYPE: found 'MASSLESS'"),
    (
        "exponential",
        "surfaces",
        pair("*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=EXPONENTIAL\n1e-3, 1e5\n"),
        "EXPONENTIAL",
    ),
    (
        "general contact",
        "surfaces",
        {JOINT: LAW + "*CONTACT\n*CONTACT INCLUSIONS, ALL EXTERIOR\n"},
        "*CONTACT: not available",
    ),
    (
        "friction that changes",
        "surfaces",
        {
            **pair("*FRICTION\n0.6\n"),
            "*DLOAD": "*CHANGE FRICTION, INTERACTION=ROCK\n*FRICTION\n0.\n*DLOAD",
        },
        "*CHANGE FRICTION: not available",
    ),
    (
        "kinematic hardening",
        "block",
        above("*SOLID", "*PLASTIC, HARDENING=KINEMATIC\n3e8, 0.\n"),
        "HARDENING: found 'KINEMATIC'",
    ),
    ("rates", "block", above("*SOLID", "*PLASTIC, RATE=0.1\n3e8, 0.\n"), "*PLASTIC: "),
    (
        "initial stresses",
        "block",
        above("*STEP", "*INITIAL CONDITIONS, TYPE=STRESS\nDAM, 1., 1., 1., 0., 0., 0.\n"),
        "*INITIAL CONDITIONS: TYPE: found 'STRESS'",
    ),
    ("large strains", "block", {"*STEP": "*STEP, NLGEOM"}, "*STEP: large strains"),
    ("large strains, yes", "block", {"*STEP": "*STEP, NLGEOM=YES"}, "*STEP: large strains"),
    (
        "explicit",
        "block",
        {"*STATIC": "*DYNAMIC, EXPLICIT\n0.1, 1."},
        "*DYNAMIC: EXPLICIT is not available",
    ),
    ("riks", "block", {"*STATIC": "*STATIC, RIKS"}, "*STATIC: "),
    ("stabilize", "block", {"*STATIC": "*STATIC, STABILIZE"}, "*STATIC: "),
    (
        "orientation of a section",
        "block",
        {SOLID: SOLID.replace("\n", ", ORIENTATION=O\n")},
        "*SOLID SECTION: ",
    ),
    ("composite", "block", {SOLID: SOLID.replace("\n", ", COMPOSITE\n")}, "*SOLID SECTION: "),
    (
        "parameter",
        "block",
        above("*NODE", "*PARAMETER\nheight = 3.\n"),
        "*PARAMETER: not available",
    ),
    (
        "rigid body",
        "block",
        above("*BOUNDARY", "*RIGID BODY, NSET=TOP, REF NODE=1\n"),
        "*RIGID BODY: not available",
    ),
    (
        "coupling",
        "block",
        above(
            "*BOUNDARY",
            "*COUPLING, CONSTRAINT NAME=C, REF NODE=1, SURFACE=UPSTREAM\n*KINEMATIC\n1, 3\n",
        ),
        "*COUPLING: not available",
    ),
    (
        "transform",
        "block",
        above("*BOUNDARY", "*TRANSFORM, NSET=TOP\n1., 1., 0., -1., 1., 0.\n"),
        "*TRANSFORM: not available",
    ),
    (
        "orientation",
        "block",
        above("*MATERIAL", "*ORIENTATION, NAME=O\n1., 0., 0., 0., 1., 0.\n"),
        "*ORIENTATION: not available",
    ),
    ("shells", "block", {"TYPE=C3D8": "TYPE=S4R"}, "*ELEMENT: TYPE: found 'S4R', a shell"),
    ("beams", "block", {"TYPE=C3D8": "TYPE=B31"}, "*ELEMENT: TYPE: found 'B31', a beam"),
    (
        "springs",
        "block",
        {"TYPE=C3D8": "TYPE=SPRINGA"},
        "*ELEMENT: TYPE: found 'SPRINGA', a spring",
    ),
    (
        "tetrahedra",
        "block",
        {"TYPE=C3D8": "TYPE=C3D10"},
        "*ELEMENT: TYPE: found 'C3D10', a tetrahedron",
    ),
    (
        "expansion without a comma",
        "block",
        above("*SOLID", "*EXPANSION TYPE=ISO\n1e-5\n"),
        "*EXPANSION TYPE=ISO: unknown keyword",
    ),
    (
        "too many nodes",
        "block",
        {"6, 7, 8\n*NSET": "6, 7, 8, 9\n*NSET"},
        "*ELEMENT: more than 8 nodes",
    ),
]


def named(rows):
    return [pytest.param(*row[1:], id=row[0]) for row in rows]


@pytest.mark.parametrize(("base", "edits"), named(READ))
def test_honoured(keyway, base, edits):
    keyway(changed(base, edits))


@pytest.mark.parametrize(("base", "edits", "says"), named(REFUSED))
def test_refused(keyway, base, edits, says):
    """The first message names keyword and reason, with file and line."""
    run = keyway(changed(base, edits), code=2)
    heads = [
        line for line in run.stderr.splitlines() if "job.inp:" in line and "warning" not in line
    ]
    assert says in heads[0]
    assert "expected" in heads[0] or "did you mean" in heads[0]


def test_names_of_state_variables_are_noted(keyway):
    """The UMAT alone is missing in this deck."""
    names = '*USER MATERIAL, CONSTANTS=2\n22e9, 0.2\n*DEPVAR\n2\n1, ONE, "first"\n2, TWO, "second"'
    run = keyway(changed("block", {"*ELASTIC\n22e9, 0.2": names}), code=2)
    errors = [x for x in run.stderr.splitlines() if "job.inp:" in x and "warning" not in x]
    assert len(errors) == 1
    assert "no UMAT is given" in errors[0]
