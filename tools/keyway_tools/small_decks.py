"""The small decks of input/: each shows one feature and gives the expected number."""

from __future__ import annotations

from .deck_cracking_monolith import cracking_monolith, monolith_motion
from .deck_monolith import monolith_mesh, monolith_water
from .deck_opening_base import opening_base
from .deck_petersson import petersson_beam
from .decks_dynamic import monolith_frequencies, sliding_base, sliding_block
from .decks_static import block_on_joint, cantilever, gravity_column

SMALL_DECKS = {
    "cantilever.inp": cantilever,
    "gravity_column.inp": gravity_column,
    "block_on_joint.inp": block_on_joint,
    "sliding_block.inp": sliding_block,
    "sliding_block_base.txt": sliding_base,
    "opening_base.inp": opening_base,
    "monolith_frequencies.inp": monolith_frequencies,
    "monolith_water.inp": monolith_water,
    "meshes/monolith_mesh.inp": monolith_mesh,
    "petersson_beam.inp": petersson_beam,
    "cracking_monolith.inp": cracking_monolith,
    "cracking_monolith_motion.txt": monolith_motion,
}
