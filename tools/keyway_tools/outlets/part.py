"""A part of an arch dam with outlets: elements left out, elements added downstream."""

from __future__ import annotations

import numpy as np

from ..arch_lattice import Part, in_cells
from ..arch_stations import TooCoarseError
from .options import Layout, OutletOptions, layout_of

DOWN, UP = 1, 2  # faces of bricks


class OutletPart(Part):
    """A part whose every column starts at its lowest level."""

    def __init__(self, outlets: OutletOptions, *arguments) -> None:
        """As Part, after the outlets."""
        super().__init__(*arguments)
        self.first = arguments[-1]
        if any(self.foot(i) > self.bottom for i in range(self.left, self.right + 1)):
            raise ValueError(
                f"block {outlets.block} with its outlets meets the rock where it is finer; "
                "expected a larger --fine-above"
            )
        self.outlets = outlets
        self.layout = self._place()
        if self.layout.corbel < self.bottom:
            # levels are rounded to elements: a finer mesh may help by a level or two
            is_near = self.bottom - self.layout.corbel <= 2
            raise (TooCoarseError if is_near else ValueError)(
                f"the corbel below the outlets begins under the height above which block "
                f"{outlets.block} is finer; expected a smaller --fine-above or --corbel-depth, or "
                "a larger --outlet-sill"
            )
        self._leave_out()
        self._build_downstream()
        self._drop_unused()

    def _place(self) -> Layout:
        shape = self.lattice.shape
        heights = np.linspace(0.0, shape.height, self.lattice.top * self.mesh.refine + 1)
        ends = [np.append(self._point(i, self.top, 1.0), 0.0)[:2] for i in (self.left, self.right)]
        width = float(np.linalg.norm(ends[1] - ends[0]))
        return layout_of(self.outlets, self.right - self.left, width, heights)

    def _point(self, column: int, level: int, share: float) -> np.ndarray:
        refine = self.mesh.refine
        at = in_cells(column, refine), in_cells(level, refine)
        return self.lattice.line(*at, np.array([share]))[0]

    def _leave_out(self) -> None:
        """Remove the bricks of the holes."""
        place = np.array([
            (column, level)
            for column in range(self.right - self.left)
            for level in range(self.bottom, self.top)
            for _ in range(self.mesh.thick)
        ])  # fmt: skip
        stays = np.array([not self.layout.is_hole(*at) for at in place.tolist()])
        number = np.cumsum(stays) - 1
        self.places = place[stays]
        self.bricks = self.bricks[stays]
        for name, faces in self.faces.items():
            self.faces[name] = [(int(number[b]), face) for b, face in faces if stays[b]]

    def _out(self, level: int) -> float:
        """Length of what stands downstream of the face at a level [m]."""
        at = self.layout
        share = min(1.0, (level - at.corbel) / max(at.sill - at.corbel, 1))
        tip = self.outlets.corbel_tip
        return self.outlets.pier_length * (tip + (1.0 - tip) * share)

    def _build_downstream(self) -> None:
        """Add corbel and piers, and let the downstream face follow them."""
        at, layers = self.layout, self.outlets.num_layers
        self.piers: dict[tuple[int, int], np.ndarray] = {}
        bricks, outer, covered = [], [], set()
        for column in range(*at.built):
            for level in range(at.corbel, at.top):
                if not at.is_built(column, level):
                    continue
                covered.add((column, level))
                corners = [(0, 0), (1, 0), (1, 1), (0, 1)]
                lines = [self._pier_line(self.left + column + a, level + b) for a, b in corners]
                outer.append((len(self.bricks) + len(bricks), DOWN))
                for k in range(layers):
                    bricks.append([line[k] for line in lines] + [line[k + 1] for line in lines])
        places = self.places.tolist()
        kept = [face for face in self.faces["DOWNSTREAM"] if tuple(places[face[0]]) not in covered]
        self.faces["DOWNSTREAM"] = kept + outer
        self.bricks = np.concatenate((self.bricks, np.array(bricks)))

    def _pier_line(self, column: int, level: int) -> np.ndarray:
        """Nodes from the downstream end to the face."""
        if (column, level) not in self.piers:
            near, far = self._point(column, level, 0.0), self._point(column, level, 1.0)
            along = (near - far) * np.array([1.0, 1.0, 0.0])
            along *= self._out(level) / np.linalg.norm(along)
            layers = self.outlets.num_layers
            shares = np.arange(layers, 0, -1)[:, None] / layers
            new = self.first + len(self.x) + np.arange(layers)
            self.x = np.concatenate((self.x, near + shares * along))
            self.piers[column, level] = np.append(new, self.nodes[column, level][0])
        return self.piers[column, level]

    def _drop_unused(self) -> None:
        """Drop the nodes inside the holes."""
        used = np.zeros(len(self.x), dtype=bool)
        used[self.bricks - self.first] = True
        number = np.where(used, self.first + np.cumsum(used) - 1, -1)
        self.x = self.x[used]
        self.bricks = number[self.bricks - self.first]
        for table in (self.nodes, self.piers):
            for key, nodes in table.items():
                table[key] = number[nodes - self.first]
