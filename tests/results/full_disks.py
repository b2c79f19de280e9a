"""A disk that fills while a run writes (full_disk.c), and the table of docs/reliability.md."""

from __future__ import annotations

import errno
import json
import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import h5py
import pyvista
from restart_case import contents, deck, differences

SOURCE = Path(__file__).with_name("full_disk.c")
UMAT = Path(__file__).resolve().parents[2] / "input" / "umat" / "plastic_j2.f90"


@dataclass(frozen=True)
class Disk:
    """The disk is full when files whose paths end with `name` have grown by `size` bytes in all."""

    name: str
    size: int
    error: int = errno.ENOSPC
    has_inodes: bool = False  # files without bytes can still be made


# The bytes are such that the file is the one that fills the disk, in the middle of the run.
DISKS = {
    "energy": Disk("job_energy.csv", 12_000),
    "nodes": Disk("job_node_TOP.csv", 30_000),
    "first table": Disk("job_el_FOOT.csv", 10),
    "joint": Disk("job_joint_BED.csv", 50_000),
    "vtu": Disk("job_0009.vtu.part", 4_000),
    "pvd": Disk("job.pvd.part", 9_000),
    "envelope": Disk("_envelope_step3.vtu.part", 1_000),
    "modes": Disk("_modes_step2.vtu.part", 1_000),
    "h5 at its start": Disk("job.h5", 20_000),
    "h5": Disk("job.h5", 300_000),
    "h5 later": Disk("job.h5", 700_000),
    "checkpoint": Disk("job.ckpt_new.h5.part", 100_000),
    "checkpoint later": Disk("job.ckpt_new.h5.part", 1_500_000),
    "journal": Disk("job.undo_new", 100),
    "journal later": Disk("job.undo", 150_000),
    "json at its start": Disk("job.json.part", 10_000),
    "json at the end": Disk("job.json.part", 30_000),
    "log at its start": Disk("job.log", 100),
    "log": Disk("job.log", 9_000),
    "lock": Disk("job.lock", 3),
    "nothing": Disk("", 0),
    "nothing but inodes": Disk("", 0, has_inodes=True),
    "input and output error": Disk("job.h5", 400_000, errno.EIO),
    "quota": Disk("", 2_000_000, errno.EDQUOT),
    "inodes": Disk("", 2_500_000, has_inodes=True),
}


def build_library(folder: Path) -> Path:
    """The library that makes a disk full for a process."""
    library = folder / "full_disk.so"
    subprocess.run(["cc", "-shared", "-fPIC", "-O1", "-o", library, SOURCE, "-ldl"], check=True)
    return library


def settings_of(disk: Disk, library: Path, out: Path) -> dict[str, str]:
    """The environment of a program whose disk becomes full; `out` is the folder on the disk."""
    return {
        "LD_PRELOAD": str(library),
        "FULL_DISK_FOLDER": str(out),
        "FULL_DISK_NAME": disk.name,
        "FULL_DISK_BYTES": str(disk.size),
        "FULL_DISK_ERRNO": str(disk.error),
        "FULL_DISK_FILES": str(int(disk.has_inodes)),
    }


def run_on(disk: Disk, library: Path, out: Path, command: list) -> subprocess.CompletedProcess[str]:
    """Runs the program with a disk that becomes full."""
    settings = settings_of(disk, library, out)
    return subprocess.run(command, env={**os.environ, **settings}, capture_output=True, text=True)


def unreadable(out: Path) -> list[str]:
    """Files of results in a folder that cannot be read to their ends, and files half written."""
    bad = []
    for path in sorted(p for p in out.rglob("*") if p.is_file()):
        try:
            if path.suffix == ".csv":
                text = path.read_text()
                commas = {line.count(",") for line in text.splitlines()}
                assert not text or (text.endswith("\n") and len(commas) == 1)
            elif path.suffix == ".json":
                json.loads(path.read_text())
            elif path.suffix == ".h5" and ".ckpt" not in path.name:
                contents(path)
            elif path.suffix == ".vtu":
                assert pyvista.read(path).n_points > 0
            elif path.suffix == ".pvd":
                reader = pyvista.PVDReader(path)
                reader.set_active_time_point(len(reader.time_values) - 1)
                reader.read()
            assert path.suffix not in (".part", ".lock")
        except Exception:  # whatever a reader raises, the file is not readable
            bad.append(str(path.relative_to(out)))
    return bad


def rows_in_h5(out: Path) -> int:
    """Increments in job.h5."""
    with h5py.File(out / "job.h5") as file:
        return len(file["history/energy"])


def main(program: Path, folder: Path) -> None:
    """Prints the table of docs/reliability.md: program, an empty folder."""
    library, umat, path = build_library(folder), folder / "j2.so", folder / "job.inp"
    path.write_text(deck())
    subprocess.run([program, "--umat", UMAT, "--umat-library", umat], check=True)
    options = ["-q", "-j", "1", "--umat", umat]
    subprocess.run([program, *options, "-o", folder / "whole", path], check=True)
    print("| the disk fills with | exit | job.json | not readable | then --continue |")
    print("|---|---|---|---|---|")
    for number, (name, disk) in enumerate(DISKS.items()):
        out = folder / f"full_{number}"
        done = run_on(disk, library, out, [program, *options, "-o", out, path])
        summary = out / "job.json"
        status = json.loads(summary.read_text())["status"] if summary.exists() else "none"
        bad = ", ".join(unreadable(out)) if out.exists() else ""
        goes_on = "no checkpoint yet"
        if list(out.glob("*.ckpt*.h5")):
            again = subprocess.run([program, *options, "-o", out, "--continue", path])
            same = again.returncode == 0 and not differences(folder / "whole", out)
            goes_on = "the same files" if same else f"code {again.returncode}"
        print(f"| {name} | {done.returncode} | {status} | {bad} | {goes_on} |", flush=True)


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
