#!/usr/bin/env python3
"""Write the decks of the Jinping dam: `tools/make_jinping.py` writes those of input/jinping.

    tools/make_jinping.py                               # all of input/jinping, with their meshes
    tools/make_jinping.py my/dam.inp --unknowns 15000 --law fracture-energy --duration 5
    tools/make_jinping.py my/dam.inp --kn 1e11 --friction 0.3 --picture

Options that are not named here are those of tools/make_dam.py.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import keyway_tools.own_python  # noqa: F401 - before packages
from keyway_tools.arch_size import MOST_UNKNOWNS
from keyway_tools.command import Parser, command
from keyway_tools.jinping.concrete import LAWS, RECOVERIES
from keyway_tools.jinping.decks import DURATION, FULL, INCREMENT, SMALL, JinpingDeck, write_deck
from keyway_tools.option_types import above_zero, count, count_from_zero, deck_path

INPUT = Path(__file__).resolve().parents[1] / "input"
BLOCK, JOINTS = 4, (6, 7)  # of the outlets, and the numbers of joints at which it is the middle one
KEPT = {
    "jinping": JinpingDeck(),
    "jinping_fracture_energy": JinpingDeck(law="fracture-energy"),
    "jinping_without_outlets": JinpingDeck(has_outlets=False),
}


def read_options(arguments: list[str] | None) -> argparse.Namespace:
    """The command line."""
    parser = Parser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    add = parser.add_argument
    add("deck", type=deck_path, nargs="?", help="deck to write (all of input/jinping)")
    add(
        "--unknowns",
        type=count,
        help=f"at least ({FULL}; {SMALL}: for trials; up to {MOST_UNKNOWNS})",
    )
    add("--law", choices=LAWS, help="of the concrete (table1)")
    add("--recovery", choices=RECOVERIES, help="of stiffness in compression (ENERGY)")
    add("--no-outlets", action="store_true", help="leave out outlets, piers and corbel")
    add("--duration", type=above_zero, help=f"of the motion [s] ({DURATION:g})")
    add("--increment", type=above_zero, help=f"of the motion [s] ({INCREMENT:g}; G_f: 0.01)")
    add("--motion-of", type=Path, default=INPUT / "xingbiling", help="folder of the motion")
    chosen, chosen.others = parser.parse_known_args(arguments)
    if chosen.deck is None and any(
        value for name, value in vars(chosen).items() if name != "motion_of"
    ):
        parser.error("name the deck to which the options apply")
    return chosen


def check_outlets(options: list[str]) -> None:
    """Raises ValueError for numbers of joints at which the block of the outlets is not there."""
    parser = Parser(prog="make_jinping", add_help=False, allow_abbrev=False)
    parser.add_argument("--joints", type=count_from_zero)
    parser.add_argument("--joint-places", nargs="+", default=[])
    for name in ("--fine", "--outlets"):  # other blocks, or none: make_dam checks them
        parser.add_argument(name, nargs="+")
    given, _ = parser.parse_known_args(options)
    joints = len(given.joint_places) or given.joints
    if joints not in (None, *JOINTS) and not (given.fine or given.outlets):
        raise ValueError(
            f"{joints} joints: the outlets stand in block {BLOCK}, the middle one of {JOINTS[0]} "
            f"or {JOINTS[1]} joints; expected --no-outlets, or --fine with another block"
        )


@command("make_jinping")
def main(arguments: list[str] | None = None) -> int:
    """Write one deck, or those of input/jinping."""
    chosen = read_options(arguments)
    if chosen.deck is None:
        decks = {INPUT / "jinping" / f"{name}.inp": deck for name, deck in KEPT.items()}
    else:
        usual = JinpingDeck()
        one = JinpingDeck(
            law=chosen.law or usual.law,
            recovery=chosen.recovery or usual.recovery,
            has_outlets=not chosen.no_outlets,
            unknowns=chosen.unknowns or usual.unknowns,
            duration=chosen.duration or usual.duration,
            increment=chosen.increment,
            options=tuple(chosen.others),
        )
        try:
            if one.has_outlets:
                check_outlets(chosen.others)
        except ValueError as fault:
            print(f"make_jinping: {fault}", file=sys.stderr)
            return 2
        decks = {chosen.deck: one}
    return max(write_deck(deck, path, chosen.motion_of) for path, deck in decks.items())


if __name__ == "__main__":
    sys.exit(main())
