"""The dam in motion: a film (mp4) or a moving picture (gif) of the saved displacements."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from PIL import Image

from .colour_scale import FIELDS, Limits, Scales
from .dam_views import Faces
from .picture_style import headline, plt
from .pictures_faces import Drawing, draw_page
from .pictures_shapes import round_factor
from .render_dam import Paint, Picture, render_views

MOST_FRAMES = 200
FRAMES_PER_SECOND = 12
KINDS = ("mp4", "gif")


def animate(faces: Faces, scales: Scales, path: Path) -> list[Path]:
    """Write all saved displacements, or 200 of them, as one film; nothing for fewer than three."""
    saved = sorted(faces.results.displacements(), key=lambda one: one[1])
    if len(saved) < 3:
        return []
    chosen = np.unique(np.linspace(0, len(saved) - 1, min(MOST_FRAMES, len(saved))).astype(int))
    frames = _frames(faces, scales, [saved[k] for k in chosen])
    path.parent.mkdir(parents=True, exist_ok=True)
    (_write_mp4 if path.suffix == ".mp4" else _write_gif)(frames, path)
    return [path]


def _frames(faces: Faces, scales: Scales, saved: list[tuple[str, float]]) -> Iterator[np.ndarray]:
    """Images of the same size, one a state; enlargement and colours are those of the whole run."""
    sizes = np.array([
        np.linalg.norm(faces.results.displacement(place)[faces.nodes], axis=1).max()
        for place, _ in saved
    ])  # fmt: skip
    factor = round_factor(faces.size, float(sizes.max()))
    limits = scales.limits("U", sizes)
    page = None
    for place, time in saved:
        pictures = _state(faces.at(place), faces.results.displacement(place), factor, limits)
        heading = f"t = {time:.2f} s, displacements drawn {factor:g} times\n{faces.results.note}"
        if page is None:
            colours = FIELDS["U"].colours
            page = draw_page(Drawing(pictures, limits, colours, "displacement [mm]", heading))
            page.set_dpi(100)
            page.canvas.draw()
            page.set_layout_engine("none")  # the layout of the first image serves all
        headline(page, heading, grows=False)
        for axis, picture in zip(page.axes, pictures.values(), strict=False):
            axis.images[0].set_data(picture.image)
        yield _pixels(page)
    plt.close(page)


def _state(faces: Faces, u: np.ndarray, factor: float, limits: Limits) -> dict[str, Picture]:
    """The displaced dam from all sides."""
    shown = FIELDS["U"]
    length = shown.scale * np.linalg.norm(u, axis=1)
    paint = Paint(length, limits.ends, shown.colours, limits.bands)
    wire = Faces(faces.results).surface()
    body, lines = faces.grid(factor * u), faces.joint_lines(factor * u)
    return render_views(faces.with_above(), body, paint, lines, wire, fixed=1.25)


def _pixels(figure) -> np.ndarray:
    """The figure as an image whose sides are even, as films need them."""
    figure.canvas.draw()
    image = np.asarray(figure.canvas.buffer_rgba())[..., :3]
    return np.ascontiguousarray(image[: image.shape[0] // 2 * 2, : image.shape[1] // 2 * 2])


def _write_mp4(frames: Iterator[np.ndarray], path: Path) -> None:
    import imageio_ffmpeg

    first = next(frames)
    size = (first.shape[1], first.shape[0])
    film = imageio_ffmpeg.write_frames(
        str(path), size, fps=FRAMES_PER_SECOND, quality=7, macro_block_size=2
    )
    film.send(None)
    film.send(first)
    for frame in frames:
        film.send(frame)
    film.close()


def _write_gif(frames: Iterator[np.ndarray], path: Path) -> None:
    images = [Image.fromarray(frame).quantize(128, dither=Image.Dither.NONE) for frame in frames]
    images[0].save(
        path, save_all=True, append_images=images[1:], duration=1000 // FRAMES_PER_SECOND, loop=0
    )
