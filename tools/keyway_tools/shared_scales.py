"""One range of colours for several runs."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from .colour_scale import FIELDS, Scales
from .dam_views import Faces
from .pictures_joints import last_slips
from .si_results import SiResults


def shared_scales(all_results: list[SiResults], scales: Scales) -> Scales:
    """One range of each field for several runs: the largest of theirs."""
    ends = {}
    for results in all_results:
        for step in [step for step in results.steps() if step.envelopes][-1:]:
            nodes = Faces(results, step.number).nodes
            for name in step.envelopes:
                end = scales.end(name, step.envelopes[name][nodes])
                ends[name] = max(ends.get(name, 0.0), end)
        slips = [np.zeros(1), *last_slips(results)[0].values()]
        ends["SLIP"] = max(ends.get("SLIP", 0.0), scales.end("SLIP", np.concatenate(slips)))
    found = {name: end for name, end in ends.items() if end > 0.0 and not FIELDS[name].top}
    return replace(scales, shared=found)
