"""Decks, runs and results of Keyway from Python.

import keyway

run = keyway.run("dam.inp", threads=2, results="results/dam")
run = keyway.open("results/dam")
run.openings.plot(x="time")          # a pandas DataFrame
run.fields(time=12.5).plot(scalars="S1")  # a PyVista mesh

deck = keyway.Deck("dam.inp")
deck.card("ELASTIC").data[0][0] = 30e9
deck.write("stiff.inp")
"""

from keyway_tools.program import find_program

from .deck import Card, Deck, DeckError
from .job_schema import job_schema
from .run_results import RunResults, open_run
from .running import Fault, RunError, run

open = open_run

__all__ = [
    "Card",
    "Deck",
    "DeckError",
    "Fault",
    "RunError",
    "RunResults",
    "find_program",
    "job_schema",
    "open",
    "run",
]
