"""The motions of the study: that of input/xingbiling, other seeds, one without a component."""

from __future__ import annotations

import shlex
import shutil
from dataclasses import dataclass
from pathlib import Path

import make_jinping
import make_motion

KEPT = make_jinping.INPUT / "xingbiling"  # seed 3, 20 s


@dataclass(frozen=True)
class Motion:
    """An artificial motion of the spectrum of input/xingbiling."""

    seed: int = 3
    duration: float = 20.0  # [s]
    is_symmetric: bool = False  # without the component across the valley

    @property
    def is_kept(self) -> bool:
        """Whether input/ has it."""
        return self.seed == 3 and not self.is_symmetric

    def folder(self, motions: Path) -> Path:
        """Where its files are or will be."""
        if self.is_kept:
            return KEPT
        return motions / (f"seed_{self.seed}" + ("_symmetric" if self.is_symmetric else ""))

    def command(self, motions: Path) -> str:
        """The command line that makes it; a symmetric one is a kept one with x set to zero."""
        if self.is_symmetric:
            return f"# {self.folder(motions)}: the motion of {KEPT} with zero along x"
        return shlex.join(["tools/make_motion.py", *self._arguments(motions)])

    def make(self, motions: Path) -> None:
        """Write its files where they are not there yet."""
        made = self.folder(motions)
        if self.is_kept or (made / "motion_z.txt").exists():
            return
        made.mkdir(parents=True, exist_ok=True)
        if not self.is_symmetric:
            make_motion.main(self._arguments(motions))
            return
        count = len((KEPT / "motion_x.txt").read_text().split())
        (made / "motion_x.txt").write_text("0.\n" * count)
        for axis in "yz":
            shutil.copyfile(KEPT / f"motion_{axis}.txt", made / f"motion_{axis}.txt")

    def _arguments(self, motions: Path) -> list[str]:
        file = self.folder(motions) / "motion"
        duration = f"{self.duration:g}"
        return ["-o", str(file), "--seed", str(self.seed), "--duration", duration, "--no-pictures"]


MOTION = Motion()
