"""Options of tools/make_dam.py that would make a deck that the program refuses."""

from __future__ import annotations

import argparse

import numpy as np

from .arch_deck import DeckOptions
from .arch_shape import ArchShape
from .mesh_data import BrickMesh
from .mesh_quality import corner_jacobians, find_faults

MOST_PRINTED = 2**31 - 1  # integers of a deck
# Options of the dynamic step or of its motion, with their defaults
OF_MOTION = {
    "motion_dt": None,
    "motion_unit": None,
    "duration": DeckOptions.duration,
    "increment": DeckOptions.increment,
    "damping": DeckOptions.damping,
    "damping_base": DeckOptions.damping_base,
    "reduced": None,
}


def check_deck_options(chosen: argparse.Namespace) -> None:
    """Words, constants and times of the deck. Raises ValueError."""
    _check_words(chosen)
    _check_materials(chosen)
    _check_damping(*chosen.damping)
    if chosen.motion and chosen.increment > chosen.duration:
        raise ValueError(
            f"--increment {chosen.increment:g}: expected at most the duration, "
            f"{chosen.duration:g} s"
        )
    if chosen.picture_every > MOST_PRINTED:
        raise ValueError(f"--picture-every {chosen.picture_every}: expected up to {MOST_PRINTED}")


def check_motion_options(chosen: argparse.Namespace) -> None:
    """Without a motion there is no dynamic step. Raises ValueError."""
    if chosen.motion:
        return
    for name, default in OF_MOTION.items():
        value = getattr(chosen, name)
        if (tuple(value) if isinstance(value, list) else value) != default:
            raise ValueError(f"--{name.replace('_', '-')} has no effect without --motion FILE")


def _check_words(chosen: argparse.Namespace) -> None:
    """The title is a line of the deck, a note a paragraph of its header."""
    title = chosen.title or ""
    if len(title.splitlines()) > 1 or title.lstrip().startswith("*"):
        raise ValueError(f"--title {chosen.title!r}: expected one line that begins without '*'")
    for note in chosen.note:
        head, _, text = note.partition(": ")
        if not head.strip() or not text.strip():
            raise ValueError(f"--note '{note}': expected the form 'Head: text'")


def _check_materials(chosen: argparse.Namespace) -> None:
    """Constants of concrete and rock."""
    for name in ("concrete", "rock"):
        given = getattr(chosen, name)
        modulus, ratio, *density = given
        found = f"--{name} {' '.join(f'{value:g}' for value in given)}"
        if modulus <= 0.0 or not -1.0 < ratio < 0.5 or min(density, default=0.0) < 0.0:
            rest = ", RHO of 0 or more" if density else ""
            raise ValueError(f"{found}: expected E above 0, NU in -1..0.5{rest}")
        if (chosen.motion or chosen.modes) and density == [0.0]:
            raise ValueError(f"{found}: expected RHO above 0 with --motion or --modes")


def _check_damping(ratio: float, first: float, second: float) -> None:
    """The limits of *DAMPING (keywords.md)."""
    found = f"--damping {ratio:g} {first:g} {second:g}"
    if ratio >= 1.0:
        raise ValueError(f"{found}: expected a RATIO of 0 or more and below 1")
    if not 0.0 < first < second:
        raise ValueError(f"{found}: expected frequencies above 0, F1 below F2")


def check_mesh(mesh: BrickMesh, shape: ArchShape) -> None:
    """Raises ValueError for a mesh with faults, with the options that make them."""
    inverted = (corner_jacobians(mesh) <= 0.0).any(axis=1)
    for name, why in (("DAM", why_dam_is_inverted(shape)), ("ROCK", WHY_ROCK_IS_INVERTED)):
        count = int(inverted[mesh.brick_sets.get(name, [])].sum())
        if count:
            raise ValueError(f"{count} elements of the {name.lower()} are inside out: {why}")
    if faults := find_faults(mesh):
        raise ValueError(f"the mesh has faults: {'; '.join(faults)}")


WHY_ROCK_IS_INVERTED = (
    "layers of rock cross beside so narrow a valley; expected a longer --crest-arc, or a smaller "
    "--extent or --height"
)


def why_dam_is_inverted(shape: ArchShape) -> str:
    """The reason in the shape, and the options that mend it."""
    z = np.linspace(0.0, shape.height, 101)
    end = shape.abutment_angle(z)
    for angle in (np.zeros_like(z), end):
        far, thick = shape.upstream_distance(angle, z), shape.thickness(z, angle)
        worst = int(np.argmin(far - thick))
        if far[worst] <= thick[worst]:
            return (
                f"at z = {z[worst]:.4g} m the arch is {thick[worst]:.4g} m thick, {far[worst]:.4g} "
                "m from the axis of the dam; expected a longer --crest-arc, or a smaller "
                "--base-thickness or --crest-thickness"
            )
    if np.diff(end).min() <= 0.0:
        return (
            f"the crest of {shape.crest_arc:g} m is too short for a height of {shape.height:g} m: "
            "the planes of the mesh, through the axis of the dam, cross the abutment twice; "
            "expected a longer --crest-arc, or a smaller --height, --bottom-width or "
            "--crest-overhang"
        )
    return (
        "the arches are too curved for their thickness; expected a longer --crest-arc, or a "
        "smaller --base-thickness, --crest-thickness, --crest-angle or --crest-overhang"
    )
