"""Records of any kind as files that a deck reads: one value a line, in m/s2."""

from __future__ import annotations

import math
from pathlib import Path

from ..motion_files import write_amplitude
from .columns import refuse_dt
from .read_record import read_record
from .record import AXES
from .treatment import same_times

USUAL_TIME = 0.01  # between values of one column [s]


def is_plain(path: Path) -> bool:
    """Whether a file has one number a line, which a deck reads as it is."""
    words = [w for line in path.read_text(errors="replace").splitlines() if (w := line.strip())]
    try:
        return bool(words) and all(math.isfinite(float(word)) for word in words)
    except ValueError:
        return False


def check_number(components: int) -> None:
    """Raises ValueError if there are more components than axes."""
    if components > len(AXES):
        raise ValueError(f"motion takes files along x, y, z; found {components} components")


def motion_files(
    files: list[Path], unit: str | None, dt: float | None, prefix: Path
) -> tuple[list[Path], float]:
    """Files along x, y, z with values in m/s2, and the time between the values [s].

    Files of one column of values in m/s2 are taken as they are. Others are read as records and
    written as PREFIX_x.txt, PREFIX_y.txt, PREFIX_z.txt. Raises ValueError with the file, what is
    wrong and what is expected.
    """
    usual = USUAL_TIME if dt is None else dt
    if not files:
        return [], usual
    missing = [file for file in files if not file.is_file()]
    if missing:
        raise ValueError(f"there is no motion file '{missing[0]}'")
    if unit is None and all(is_plain(file) for file in files):
        check_number(len(files))
        return files, usual
    records = [record for file in files for record in read_record(file, unit, usual)]
    if dt is not None:
        refuse_dt(records, "--motion-dt")
    check_number(len(records))
    treated = same_times(dict(zip(AXES, records, strict=False)), None)
    prefix.parent.mkdir(parents=True, exist_ok=True)
    written = []
    for axis, record in treated.items():
        written.append(prefix.with_name(f"{prefix.name}_{axis}.txt"))
        write_amplitude(written[-1], record.acceleration, record.dt, "VALUES")
    return written, treated["x"].dt
