"""The deck of an arch dam: materials, joints, water, motion, steps, requests."""

from __future__ import annotations

from dataclasses import dataclass

from .construction.heat import Temperatures
from .construction.lifts import Construction, construction_steps, joints_there
from .deck_text import comment
from .mesh_data import BrickMesh

LARGEST_ERROR = 0.5  # of *DYNAMIC, REDUCED, ACCURACY (keywords.md)


@dataclass(frozen=True)
class DeckOptions:
    """Everything of the deck but the mesh; SI units. Defaults: paper_notes.md, 3, 5, 14."""

    title: str | None = None  # None: 'Arch dam', 'with contraction joints' where it has some
    element_type: str = "C3D8"
    concrete: tuple[float, float, float] = (22.0e9, 0.167, 2400.0)  # E [Pa], nu, rho [kg/m3]
    concrete_cards: tuple[str, ...] = ()  # that follow *ELASTIC: the law of the concrete
    rock: tuple[float, float] = (20.0e9, 0.24)  # E [Pa], nu; massless
    joint_thickness: float = 0.02  # gives k_n = E / thickness, k_t = k_n / (2 (1 + nu))
    normal_stiffness: float | None = None  # k_n [Pa/m]; None: from the thickness
    shear_stiffness: float | None = None  # k_t [Pa/m]; None: from k_n or the thickness
    tensile_strength: float = 0.0  # q_on [Pa]
    friction: float = 0.6
    cohesion: float = 0.0  # [Pa]
    # of *INTERFACE [Pa/m]: the E of concrete as a number (paper_notes.md, 1)
    interface_stiffness: float = 22.0e9
    has_joint_law: bool = True  # False: the run without joints (joints bonded by a high strength)
    water_depth: float | None = 105.0  # over the foot of the crown [m]; None: empty
    added_mass_direction: str = "DIAGONAL"
    motions: tuple[str, ...] = ()  # files of the acceleration [m/s2] along x, y, z
    motion_dt: float = 0.01  # [s]
    duration: float = 10.0  # of the dynamic step [s]
    increment: float = 0.01  # [s]
    alpha: float = -0.05
    controls: str = ""  # parameters of *CONTROLS of the dynamic step
    damping: tuple[float, float, float] = (0.05, 2.0, 10.0)  # ratio at two frequencies [Hz]
    damping_base: str = "INITIAL"  # or CURRENT: the stiffness with its damage
    # of weight and water [s]; it matters to concrete with a viscosity alone
    static_time: float = 1.0
    uplift: str | None = None  # profile of the water in the joints: OPEN or LINEAR; None: no water
    reduced: float | None = None  # error of openings for a reduced model in the dynamic step
    num_modes: int = 0  # > 0: a *FREQUENCY step between the static and the dynamic one
    picture_frequency: int = 10  # increments between two states of the VTK series
    construction: Construction | None = None  # None: the dam is there at once
    heat: Temperatures | None = None  # with construction only

    def __post_init__(self) -> None:
        if self.uplift and self.water_depth is None:
            raise ValueError("--uplift needs water")
        if self.static_time <= 0.0 or (self.construction and self.static_time != 1.0):
            raise ValueError(
                f"--static-time: {self.static_time:g}; expected a time above 0, without --lifts"
            )
        if self.reduced is None:
            return
        if not 0.0 < self.reduced <= LARGEST_ERROR:
            raise ValueError(
                f"--reduced: {self.reduced:g}; expected an error above 0, up to {LARGEST_ERROR:g}"
            )
        if self.concrete_cards:
            raise ValueError("--reduced takes linear elastic concrete, not --concrete-cards")
        if self.uplift == "OPEN":
            raise ValueError("--reduced takes --uplift LINEAR, not OPEN")


def title_of(mesh: BrickMesh, given: str | None) -> str:
    """The title of a deck."""
    if given is not None:
        return given
    return "Arch dam with contraction joints" if mesh.joint_names else "Arch dam"


def arch_dam_deck(mesh: BrickMesh, heading: str, mesh_file: str, options: DeckOptions) -> str:
    """Main file of the deck, which includes the mesh by *INCLUDE."""
    title = title_of(mesh, options.title)
    parts = [comment(heading), "*HEADING", title, f"*INCLUDE, INPUT={mesh_file}"]
    parts += _materials(mesh, options) + _joints(mesh, options) + _couplings(mesh, options)
    parts += options.heat.initial_cards() if options.heat else []
    parts += ["*BOUNDARY", "FIXED, 1, 3", *_amplitudes(options), *_static_steps(mesh, options)]
    if options.num_modes > 0:
        parts += ["**", "** Natural modes: joints closed, added mass of the water included"]
        parts += ["*STEP, NAME=MODES", "*FREQUENCY", str(options.num_modes), "*END STEP"]
    if options.motions:
        parts += _dynamic_step(mesh, options)
    return "\n".join(parts) + "\n"


def _materials(mesh: BrickMesh, options: DeckOptions) -> list[str]:
    modulus, poisson, density = options.concrete
    parts = [
        "*MATERIAL, NAME=CONCRETE",
        "*DENSITY",
        f"{density}",
        "*ELASTIC",
        f"{modulus:g}, {poisson}",
        *options.concrete_cards,
        *(options.heat.material_cards() if options.heat else []),
    ]
    parts += ["*SOLID SECTION, ELSET=DAM, MATERIAL=CONCRETE"]
    if "ROCK" in mesh.brick_sets:
        parts += ["*MATERIAL, NAME=ROCK", "*ELASTIC", f"{options.rock[0]:g}, {options.rock[1]}"]
        parts += ["*SOLID SECTION, ELSET=ROCK, MATERIAL=ROCK"]
    return parts


def _joints(mesh: BrickMesh, options: DeckOptions) -> list[str]:
    if not mesh.joint_names:
        return []
    law = "*JOINT LAW, NAME=CONTRACTION"
    normal, shear = options.normal_stiffness, options.shear_stiffness
    if normal is None and mesh.interfaces:  # the quads have no solid with E
        normal = options.concrete[0] / options.joint_thickness
    if normal is None:
        law += f", THICKNESS={options.joint_thickness:g}"
    else:
        law += f", KN={normal:g}"
        shear = shear or normal / (2.0 * (1.0 + options.concrete[1]))
    if shear is not None:
        law += f", KT={shear:g}"
    strength = options.tensile_strength if options.has_joint_law else 1.0e12
    law += f", TENSILE STRENGTH={strength:g}"
    law += f", FRICTION={options.friction:g}, COHESION={options.cohesion:g}"
    parts = [law]
    if options.uplift:
        parts = [f"{law},", f"   UPLIFT=LAKE, PROFILE={options.uplift}"]
    for name in mesh.joint_names:
        if name in mesh.joint_sets:
            parts += [f"*JOINT, NAME={name}, LAW=CONTRACTION, ELSET={name}"]
        else:
            parts += [f"*JOINT, NAME={name}, LAW=CONTRACTION", ", ".join(mesh.surface_joints[name])]
    return parts


def _couplings(mesh: BrickMesh, options: DeckOptions) -> list[str]:
    """Ties, and the interfaces of the paper's chain."""
    parts = []
    for name, surfaces in mesh.ties.items():
        parts += [f"*TIE, NAME={name}", ", ".join(surfaces)]
    for name, (quads, surface) in mesh.interfaces.items():
        stiffness = f"STIFFNESS={options.interface_stiffness:g}"
        parts += [f"*INTERFACE, NAME={name}, ELSET={quads}, SURFACE={surface}, {stiffness}"]
    return parts


def _amplitudes(options: DeckOptions) -> list[str]:
    dt = f"{options.motion_dt:g}"
    names = ("MOTION_X", "MOTION_Y", "MOTION_Z")
    return [
        f"*AMPLITUDE, NAME={name}, INPUT={file}, FORMAT=VALUES, DT={dt}"
        for name, file in zip(names, options.motions, strict=False)
    ]


def _requests(mesh: BrickMesh, options: DeckOptions) -> list[str]:
    is_reduced = options.reduced is not None
    parts = ["*NODE PRINT, NSET=CROWN_CREST", "U, A" if options.motions and not is_reduced else "U"]
    for name in mesh.joint_names:
        points = f"{name}_HISTORY" if f"{name}_HISTORY" in mesh.node_sets else f"{name}_CREST"
        parts += [f"*JOINT PRINT, JOINT={name}, NSET={points}"]
    if is_reduced:
        return [*parts, "*ENVELOPE", "OPENING"]
    fields = "U, OPENING" if mesh.joint_names else "U"
    parts += [f"*NODE FILE, FREQUENCY={options.picture_frequency}", fields]
    has_law = bool(options.concrete_cards)
    damage = ", DAMAGET" if has_law else ""
    parts += [f"*EL FILE, FREQUENCY={options.picture_frequency}", f"SP{damage}"]
    kept = "S1, S3, U" + (", OPENING" if mesh.joint_names else "")
    parts += ["*ENVELOPE", kept + (", S1_POINT, S3_POINT, DAMAGET" if has_law else "")]
    return parts


def _static_steps(mesh: BrickMesh, options: DeckOptions) -> list[str]:
    """Weight and water at once, or construction and then water."""
    building = options.construction
    if building is None:
        weight = ["*DLOAD", "DAM, GRAV, 9.81, 0., 0., -1."]
        about = ["**", "** Weight of the dam and water"]
        return about + _static_step("WEIGHT", weight + _reservoir(options), mesh, options)
    fields = ["*NODE FILE", "U, OPENING" if mesh.joint_names else "U", "*EL FILE"]
    fields += ["SP, STAGE" if building.num_lifts > 1 else "SP"]
    heat = options.heat
    cooling = heat.cooling_step if heat else None
    joints = [joints_there(mesh, lift) for lift in building.grouted_after]
    parts = construction_steps(building, joints, fields, cooling)
    parts += ["**", "** Water" if options.water_depth else "** Histories from here on"]
    parts += _static_step("WATER", _reservoir(options), mesh, options)
    return parts + (heat.season_step() if heat else [])


def _static_step(name: str, loads: list[str], mesh: BrickMesh, options: DeckOptions) -> list[str]:
    first = (0.1 if options.concrete_cards else 1.0) * options.static_time
    parts = [f"*STEP, NAME={name}", "*STATIC", f"{_real(first)}, {_real(options.static_time)}"]
    return parts + loads + _requests(mesh, options) + ["*END STEP"]


def _real(value: float) -> str:
    """A number with a point, as 1. or 0.1."""
    text = f"{value:g}"
    return text if "." in text or "e" in text else f"{text}."


def _reservoir(options: DeckOptions) -> list[str]:
    if options.water_depth is None:
        return []
    lake = f"*RESERVOIR, NAME=LAKE, SURFACE=UPSTREAM, LEVEL={options.water_depth:g}, BED=0."
    if not options.motions and options.num_modes == 0:
        return [lake]  # the added mass acts in motion
    return [f"{lake},", f"   ADDED MASS=WESTERGAARD, DIRECTION={options.added_mass_direction}"]


def _dynamic_step(mesh: BrickMesh, options: DeckOptions) -> list[str]:
    ratio, f1, f2 = options.damping
    parts = ["**", "** Earthquake; motion relative to the base"]
    parts += ["*STEP, NAME=EARTHQUAKE, INC=1000000"]
    if options.controls:
        parts += [f"*CONTROLS, {options.controls}"]
    times = f"{options.increment:g}, {options.duration:g}"
    if options.concrete_cards:  # cracks may need smaller increments
        parts += [f"*DYNAMIC, ALPHA={options.alpha:g}"]
        parts += [f"{times}, {1e-4 * options.increment:g}, {options.increment:g}"]
    else:
        reduced = f", REDUCED, ACCURACY={options.reduced:g}" if options.reduced else ""
        parts += [f"*DYNAMIC{reduced}, DIRECT, ALPHA={options.alpha:g}", times]
    base = "" if options.damping_base == "INITIAL" else f", BASE={options.damping_base}"
    parts += [f"*DAMPING, RATIO={ratio:g}, F1={f1:g}, F2={f2:g}{base}"]
    for dof, name in enumerate(
        ("MOTION_X", "MOTION_Y", "MOTION_Z")[: len(options.motions)], start=1
    ):
        parts += [f"*BASE MOTION, DOF={dof}, AMPLITUDE={name}, TYPE=ACCELERATION"]
    return parts + _requests(mesh, options) + ["*END STEP"]
