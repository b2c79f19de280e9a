"""Runs decks as child processes and keeps a record of each run beside its results."""

from __future__ import annotations

import contextlib
import ctypes
import json
import os
import signal
import subprocess
import threading
import time
from dataclasses import asdict, dataclass, field
from pathlib import Path

from keyway_tools.input_digest import digest_of
from keyway_tools.job_folder import has_results, state_of, summary_of, wait_until_free

RECORD = ".batch.json"
EXTREMES = ("S1", "S3", "OPENING", "DAMAGET")
# Meaning of the exit codes of the program (deck.md, "Running").
BAD_DECK, SYSTEM_FAILED = 2, 3
STATUS_OF_CODE = {0: "finished", 1: "stopped", BAD_DECK: "bad deck", SYSTEM_FAILED: "system failed"}
IN_USE = "[folder-in-use]"  # end of the message where another run holds the folder
PR_SET_PDEATHSIG = 1  # of linux/prctl.h
_prctl = getattr(ctypes.CDLL(None), "prctl", None)
GRACE = 60.0  # seconds until a run that was asked to end is killed: increments may be long


@dataclass
class Record:
    """How a run went."""

    deck: str
    folder: str
    status: str
    digest: str = ""
    options: list[str] = field(default_factory=list)
    exit_code: int | None = None
    wall_s: float | None = None
    processor_s: float | None = None  # of all threads
    peak_memory_mb: float | None = None
    extremes: dict[str, float | None] = field(default_factory=dict)
    message: str = ""
    was_kept: bool = False  # from an earlier call
    has_results: bool = False  # the results in the folder are those of this run

    def write(self) -> None:
        text = json.dumps(asdict(self), indent=2)
        (Path(self.folder) / RECORD).write_text(text + "\n", encoding="utf-8")


def send(child: subprocess.Popen[bytes], sign: signal.Signals) -> None:
    """A signal to a child and its processes; none where they have ended since a moment ago."""
    with contextlib.suppress(ProcessLookupError):
        os.killpg(child.pid, sign)


def earlier_record(folder: Path) -> Record | None:
    """The record of an earlier run in the folder, if it can be read."""
    try:
        content = json.loads((folder / RECORD).read_text(encoding="utf-8"))
        content.setdefault("has_results", content["status"] == "finished")  # of older tools
        return Record(**content)
    except (OSError, ValueError, TypeError, KeyError):
        return None


def end_with_parent() -> None:
    """Lets a child end when this process is killed; Linux alone has the call."""
    if _prctl is not None:
        _prctl(PR_SET_PDEATHSIG, int(signal.SIGTERM), 0, 0, 0)


class DeckRunner:
    """Runs one deck after another for any number of threads, until `end` is called."""

    def __init__(
        self, program: Path, options: list[str], timeout: float | None = None,
        threads: int | None = None,
    ):  # fmt: skip
        """`threads` of each run do not change its results: a run with others is kept."""
        self.program = program
        self.options = options
        self.timeout = timeout
        self.threads = [] if threads is None else ["-j", str(threads)]
        self.version = version_of(program)
        self.is_ending = False
        self._children: set[subprocess.Popen[bytes]] = set()
        self._lock = threading.Lock()

    def is_kept(self, deck: Path, folder: Path) -> bool:
        """Whether a run of this deck has finished in the folder, and its results are there."""
        wanted = Record("", "", "", self._digest_of(deck), self.options)
        earlier = earlier_record(folder)
        return earlier is not None and is_same(earlier, wanted) and has_results(folder, deck)

    def record_of(self, deck: Path, folder: Path) -> Record:
        """What a run of this deck has left in the folder; 'not run' where it has left nothing."""
        wanted = Record(str(deck), str(folder), "not run", self._digest_of(deck))
        earlier = earlier_record(folder)
        return earlier if earlier and earlier.digest == wanted.digest else wanted

    def run(self, deck: Path, folder: Path, again: bool = False) -> Record:
        """Runs the deck, or returns the record of an equal run that finished."""
        record = Record(str(deck), str(folder), "not run", options=self.options)
        record.digest = self._digest_of(deck)
        earlier = earlier_record(folder)
        if earlier and not again and is_same(earlier, record) and has_results(folder, deck):
            earlier.was_kept = True
            earlier.deck, earlier.folder = record.deck, record.folder
            return earlier
        if self.is_ending:
            return record
        folder.mkdir(parents=True, exist_ok=True)
        (folder / RECORD).unlink(missing_ok=True)
        wait_until_free(folder, deck.stem, lambda: self.is_ending)
        if self.is_ending:
            return record
        before = state_of(folder / f"{deck.stem}.json")
        self._execute(deck, record)
        read_results(deck, record, before)
        record.write()
        return record

    def _digest_of(self, deck: Path) -> str:
        return digest_of(deck, self.version, self.options)

    def _execute(self, deck: Path, record: Record) -> None:
        command = [
            str(self.program), "-o", record.folder, *self.threads, *self.options, str(deck)
        ]  # fmt: skip
        start = time.monotonic()
        with (Path(record.folder) / "batch.out").open("wb") as output:
            child = subprocess.Popen(
                command, stdin=subprocess.DEVNULL, stdout=output, stderr=subprocess.STDOUT,
                start_new_session=True,
                # With other threads, a function between fork and exec could wait for ever.
                preexec_fn=end_with_parent if threading.active_count() == 1 else None,  # noqa: PLW1509
            )  # fmt: skip
        with self._lock:
            self._children.add(child)
        if self.is_ending:  # since a moment ago
            send(child, signal.SIGTERM)
        watch = threading.Timer(self.timeout, self._end, [child]) if self.timeout else None
        if watch:
            watch.start()
        # wait4 instead of child.wait: wait4 reports the memory of this child alone.
        _, status, usage = os.wait4(child.pid, 0)
        with self._lock:
            self._children.discard(child)
            child.returncode = os.waitstatus_to_exitcode(status)
        if watch:
            watch.cancel()
        record.wall_s = round(time.monotonic() - start, 3)
        record.processor_s = round(usage.ru_utime + usage.ru_stime, 3)
        record.peak_memory_mb = round(usage.ru_maxrss / 1024, 1)
        record.exit_code = child.returncode
        record.status = self._status(child.returncode, record.wall_s)

    def _status(self, code: int, wall: float) -> str:
        if self.is_ending and code != 0:
            return "interrupted"
        if self.timeout and wall >= self.timeout and code != 0:
            return "timed out"
        if code < 0:
            return f"killed by {signal.Signals(-code).name}"
        return STATUS_OF_CODE.get(code, f"exit code {code}")

    def _end(self, child: subprocess.Popen[bytes]) -> None:
        """Requests one child to end, and kills it if it does not."""
        for sign, patience in ((signal.SIGTERM, GRACE), (signal.SIGKILL, 0.0)):
            with self._lock:
                if child not in self._children:
                    return
                send(child, sign)
            until = time.monotonic() + patience
            while child in self._children and time.monotonic() < until:
                time.sleep(0.05)

    def stop(self) -> None:
        """Ends the running children after an exception has left `run`: nobody waits for them."""
        self.is_ending = True
        for child in list(self._children):
            send(child, signal.SIGTERM)
            try:
                child.wait(GRACE)
            except subprocess.TimeoutExpired:
                send(child, signal.SIGKILL)
                child.wait()

    def end(self) -> None:
        """Ends the running children; waiting decks are not started."""
        self.is_ending = True
        for child in list(self._children):
            self._end(child)


def is_same(earlier: Record, wanted: Record) -> bool:
    """Whether an earlier run finished with the same deck, program and options."""
    return (earlier.status, earlier.digest, earlier.options) == (
        "finished",
        wanted.digest,
        wanted.options,
    )


def version_of(program: Path) -> str:
    command = [str(program), "--version"]
    done = subprocess.run(command, capture_output=True, text=True, stdin=subprocess.DEVNULL)
    return done.stdout.strip()


def read_results(deck: Path, record: Record, before: tuple[int, int] | None) -> None:
    """Takes extremes and message from the summary, if the run has written one.

    `before` is the state of job.json when the run began. A run that fails before its first
    increment writes none, and marks that of an earlier deck: the one in the folder is not its own.
    """
    folder = Path(record.folder)
    lines = (folder / "batch.out").read_text(errors="replace").strip().splitlines() or [""]
    summary = None
    is_written = state_of(folder / f"{deck.stem}.json") not in (None, before)
    if is_written and record.exit_code != BAD_DECK and not lines[-1].endswith(IN_USE):
        summary = summary_of(folder, deck)
    if summary is None:
        if record.status == "finished":
            record.status = "no results"
        record.message = lines[-1] if record.exit_code == SYSTEM_FAILED else lines[0]
        return
    record.has_results = True
    # The system's figure includes the moment before the child process starts the program.
    memory = (summary.get("ledger") or {}).get("peak_memory_mb")
    record.peak_memory_mb = memory or record.peak_memory_mb
    envelopes = summary.get("envelopes") or {}
    for name in EXTREMES:
        extreme = (envelopes.get(name) or {}).get("anywhere") or {}
        record.extremes[name] = extreme.get("value")
    damage = (summary.get("damage") or {}).get("DAMAGET") or {}
    record.extremes["DAMAGET"] = damage.get("value")  # written also without *ENVELOPE
    record.message = summary.get("message") or ""
    if record.exit_code == SYSTEM_FAILED:
        record.message = record.message or lines[-1]
