"""Feed spoilt inputs to the reader of the program, and keep those that it can't bear.

Called by scripts/fuzz; README.md says what counts as a failure.
"""

from __future__ import annotations

import argparse
import hashlib
import multiprocessing
import os
import re
import select
import subprocess
import sys
import tempfile
import time
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

from mutate import TOKEN, make_input
from seeds import Seeds, collect, working_files

REGRESSIONS = Path(__file__).parent / "regressions"
#: Most CPU time of an input [s], and most wall time, which others on the machine take part in.
MOST_CPU, MOST_WALL = 1.0, 20.0
#: Most memory of the reader. [MiB]
MOST_MEMORY = 1024
#: Inputs that are given to the reader at once, and after how many it is started anew.
BATCH, FRESH = 100, 20000
#: Tries to make a failing input smaller.
TRIES = 400
#: Exit codes of good inputs and of those that are refused.
GOOD, REFUSED = 0, (1, 2)
SANITIZERS = {
    "ASAN_OPTIONS": "detect_leaks=0:allocator_may_return_null=1:quarantine_size_mb=16:"
    f"max_allocation_size_mb={MOST_MEMORY}:hard_rss_limit_mb={MOST_MEMORY}",
    "UBSAN_OPTIONS": "print_stacktrace=1",
    "OMP_NUM_THREADS": "1",
}
#: What a report says first, without what differs from run to run.
CAUSE = re.compile(
    r"ERROR: AddressSanitizer: [\w-]+|runtime error: .*|Fortran runtime error: .*|"
    r"AddressSanitizer: .* limit exhausted|Program received signal \w+|libgomp: .*"
)


@dataclass
class Failure:
    """An input that the reader can't bear."""

    #: What happened, the same for inputs that fail alike.
    cause: str
    #: Ending of its name, and its content.
    ending: str
    data: bytes
    report: str = ""


@dataclass
class Tally:
    """What became of some inputs."""

    codes: Counter[int] = field(default_factory=Counter)
    failures: list[Failure] = field(default_factory=list)
    longest: float = 0.0
    #: The input that took longest.
    slowest: tuple[str, bytes] = ("", b"")
    #: Most memory that a reader had. [MiB]
    memory: float = 0.0


class Reader:
    """A process that reads inputs, started anew when it died."""

    def __init__(self, program: Path, most_wall: float = MOST_WALL) -> None:
        """Make a working folder with the files that inputs may name."""
        self.program, self.most_wall = program, most_wall
        self.folder = tempfile.TemporaryDirectory(prefix="mpm3d-fuzz-")
        self.path = Path(self.folder.name)
        for name, text in working_files().items():
            (self.path / name).write_text(text)
        self.process: subprocess.Popen[bytes] | None = None
        self.pending = b""
        self.reads = 0

    def start(self) -> subprocess.Popen[bytes]:
        """Return the process."""
        if self.process is None:
            self.pending, self.reads = b"", 0
            with (self.path / "stderr").open("wb") as errors:
                self.process = subprocess.Popen(
                    [str(self.program)],
                    cwd=self.path,
                    stdin=subprocess.PIPE,
                    stdout=subprocess.PIPE,
                    stderr=errors,
                    env={**os.environ, **SANITIZERS},
                )
        return self.process

    def stop(self) -> int:
        """End the process, if need be by force, and return its exit status."""
        process, self.process = self.process, None
        if process is None:
            return 0
        assert process.stdin and process.stdout
        process.stdin.close()
        try:
            status = process.wait(timeout=5.0)
        except subprocess.TimeoutExpired:
            process.kill()
            status = process.wait()
        process.stdout.close()
        return status

    def close(self) -> None:
        """End the process and delete the working folder."""
        self.stop()
        self.folder.cleanup()

    def line(self) -> str | None:
        """Return the next line that the process prints; None when it ends or takes too long."""
        process, end = self.start(), time.monotonic() + self.most_wall
        assert process.stdout
        while b"\n" not in self.pending:
            ready, _, _ = select.select([process.stdout], [], [], max(0.0, end - time.monotonic()))
            more = os.read(process.stdout.fileno(), 65536) if ready else b""
            if not more:
                return None
            self.pending += more
        line, _, self.pending = self.pending.partition(b"\n")
        return line.decode(errors="replace")

    def memory(self) -> float:
        """Return the most memory that the process had. [MiB]."""
        try:
            status = Path(f"/proc/{self.start().pid}/status").read_text()
        except OSError:
            return 0.0
        found = re.search(r"VmHWM:\s+(\d+)", status)
        return int(found[1]) / 1024.0 if found else 0.0

    def read(self, inputs: list[tuple[str, bytes]], tally: Tally) -> None:
        """Read some inputs, and go on behind each one that the process does not survive."""
        paths = []
        for k, (ending, data) in enumerate(inputs):
            paths.append(f"{k}.{ending}")
            (self.path / paths[-1]).write_bytes(data)
        done = 0
        while done < len(inputs):
            process = self.start()
            assert process.stdin
            try:
                process.stdin.write("".join(f"{path}\n" for path in paths[done:]).encode())
                process.stdin.flush()
            except BrokenPipeError:
                pass
            while done < len(inputs):
                failure = self.take_reply(inputs[done], tally)
                done += 1
                if failure:
                    tally.failures.append(failure)
                if self.process is None:
                    break
        if self.process is not None:
            tally.memory = max(tally.memory, self.memory())
            self.reads += len(inputs)
            if self.reads >= FRESH:
                self.stop()

    def take_reply(self, given: tuple[str, bytes], tally: Tally) -> Failure | None:
        """Wait for what the process says of an input, and return what is wrong with it."""
        said = []
        while True:
            line = self.line()
            if line is None:
                return self.died(given)
            found = re.fullmatch(r"(\d+) (\d*\.\d+) \d+\..*", line)
            if found:
                break
            said.append(line)
        code, seconds = int(found[1]), float(found[2])
        tally.codes[code] += 1
        if seconds > tally.longest:
            tally.longest, tally.slowest = seconds, given
        if code not in (GOOD, *REFUSED):
            return Failure(f"exit code {code}", *given, "\n".join(said))
        if seconds > MOST_CPU:
            return Failure("slow", *given, f"{seconds} s of CPU time")
        return None

    def died(self, given: tuple[str, bytes]) -> Failure:
        """Return what the end of the process says of an input."""
        hangs = self.process is not None and self.process.poll() is None
        if hangs:
            time.sleep(0.2)
            hangs = self.process is not None and self.process.poll() is None
        if hangs and self.process:
            self.process.kill()
        status = self.stop()
        report = (self.path / "stderr").read_text(errors="replace")
        found = CAUSE.search(report)
        cause = re.sub(r"0x[0-9a-f]+|-?\d+(\.\d+)?", "N", found[0]) if found else f"exit {status}"
        if hangs:
            cause = "hang"
        place = re.search(r"(\w+\.[fF]90):(\d+)|At line (\d+) of file \S*?(\w+\.[fF]90)", report)
        if place:
            cause += f" at {place[1] or place[4]}:{place[2] or place[3]}"
        return Failure(cause, *given, report)


def check_alone(
    program: Path, ending: str, data: bytes, most_wall: float = MOST_WALL
) -> Failure | None:
    """Read one input in a process of its own."""
    reader, tally = Reader(program, most_wall), Tally()
    reader.read([(ending, data)], tally)
    reader.close()
    return tally.failures[0] if tally.failures else None


def minimise(program: Path, failure: Failure) -> bytes:
    """Leave out what a failure does not need: first lines, then words, then bytes."""
    # A hang takes all the time that it is given.
    tries, most_wall = (30, 5.0) if failure.cause == "hang" else (TRIES, MOST_WALL)

    def fails(data: bytes) -> bool:
        nonlocal tries
        tries -= 1
        again = check_alone(program, failure.ending, data, most_wall)
        return again is not None and again.cause == failure.cause

    def shorten(pieces: list[bytes]) -> list[bytes]:
        size = max(1, len(pieces) // 2)
        while pieces and tries > 0:
            i, found = 0, False
            while i < len(pieces) and tries > 0:
                shorter = pieces[:i] + pieces[i + size :]
                if fails(b"".join(shorter)):
                    pieces, found = shorter, True
                else:
                    i += size
            if size == 1 and not found:
                break
            size = max(1, size // 2)
        return pieces

    data = b"".join(shorten(failure.data.splitlines(keepends=True)))
    text = data.decode("utf-8", "surrogateescape")
    tokens = TOKEN.findall(text)
    if "".join(tokens) == text:
        data = b"".join(shorten([token.encode("utf-8", "surrogateescape") for token in tokens]))
    if len(data) < 200:
        data = b"".join(shorten([bytes([byte]) for byte in data]))
    return data


def keep(program: Path, failures: list[Failure], out: Path) -> list[Failure]:
    """Save one input of each cause, made small, and its report; return those that fail again."""
    kept = []
    out.mkdir(parents=True, exist_ok=True)
    for failure in {f.cause: f for f in reversed(failures)}.values():
        name = hashlib.sha256(failure.cause.encode()).hexdigest()[:8]
        (out / f"{name}.whole.{failure.ending}").write_bytes(failure.data)
        again = check_alone(program, failure.ending, failure.data)
        if again is None:
            # Not the input but the processes before it, or others on the machine.
            if failure.cause not in ("slow", "hang"):
                kept.append(failure)
            continue
        small = Failure(again.cause, again.ending, minimise(program, again), again.report)
        kept.append(small)
        (out / f"{name}.{small.ending}").write_bytes(small.data)
        (out / f"{name}.txt").write_text(f"{small.cause}\n\n{small.report}")
        print(f"{small.cause}\n  {out / f'{name}.{small.ending}'}", flush=True)
    return kept


def work(
    program: Path, seed: int, indices: range, end: float, results: multiprocessing.Queue[Tally]
) -> None:
    """Make and read inputs until there are enough or the time is over."""
    seeds, reader = collect(), Reader(program)
    for first in range(0, len(indices), BATCH):
        if time.monotonic() > end:
            break
        tally = Tally()
        reader.read([make_input(seeds, seed, i) for i in indices[first : first + BATCH]], tally)
        results.put(tally)
    reader.close()
    results.put(None)


def fuzz(program: Path, options: argparse.Namespace) -> Tally:
    """Read inputs in several processes, and add up what became of them."""
    end = time.monotonic() + options.seconds
    results: multiprocessing.Queue[Tally] = multiprocessing.Queue()
    indices = range(options.first, options.first + options.inputs)
    workers = [
        multiprocessing.Process(
            target=work,
            args=(program, options.seed, indices[k :: options.workers], end, results),
        )
        for k in range(options.workers)
    ]
    for worker in workers:
        worker.start()
    total, running, told = Tally(), len(workers), time.monotonic()
    while running:
        tally = results.get()
        if tally is None:
            running -= 1
            continue
        add(total, tally)
        if time.monotonic() > told + 60.0:
            told = time.monotonic()
            print(summary(total), flush=True)
    for worker in workers:
        worker.join()
    return total


def add(total: Tally, tally: Tally) -> None:
    """Add one tally to another."""
    total.codes += tally.codes
    total.failures += tally.failures
    if tally.longest > total.longest:
        total.longest, total.slowest = tally.longest, tally.slowest
    total.memory = max(total.memory, tally.memory)


def summary(tally: Tally) -> str:
    """Return a line that tells what became of the inputs."""
    refused = sum(tally.codes[code] for code in REFUSED)
    died = sum(f.cause != "slow" and not f.cause.startswith("exit code") for f in tally.failures)
    return (
        f"{tally.codes.total() + died} inputs: {tally.codes[GOOD]} read to the end, "
        f"{refused} refused, {len(tally.failures)} failures; longest {tally.longest:.2f} s, "
        f"most memory {tally.memory:.0f} MiB"
    )


def ending_of(path: Path) -> str:
    """Return the part of a name that says what the input is."""
    found = re.search(r"(\d\.)?\w+\Z", path.name)
    return found[0] if found else ""


def known_inputs() -> list[tuple[str, bytes]]:
    """Return the inputs that were found before, and all seeds."""
    found = [(ending_of(p), p.read_bytes()) for p in sorted(REGRESSIONS.iterdir())]
    seeds: Seeds = collect()
    for ending, texts in seeds.texts.items():
        found += [(ending, text.encode()) for text in texts]
    return found


def main() -> int:
    """Read the command line, the known inputs, then as many new ones as it says."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--reader", type=Path, required=True, help="the program that reads inputs")
    parser.add_argument("--inputs", type=int, default=10**9, help="new inputs, at most")
    parser.add_argument("--first", type=int, default=0, help="number of the first one")
    parser.add_argument("--seconds", type=float, default=float("inf"), help="time for new inputs")
    parser.add_argument("--seed", type=int, default=1, help="which inputs are made")
    parser.add_argument("--workers", type=int, default=os.cpu_count(), help="processes")
    parser.add_argument("--out", type=Path, default=Path("build/fuzz"), help="for failing inputs")
    parser.add_argument("files", nargs="*", type=Path, help="read these inputs only")
    options = parser.parse_args()
    program = options.reader.resolve()
    if not program.is_file():
        parser.error(f"no such file: {program}")
    if options.files:
        failed = 0
        for path in options.files:
            failure = check_alone(program, ending_of(path), path.read_bytes())
            print(f"{path}: {failure.cause + chr(10) + failure.report if failure else 'good'}")
            failed += failure is not None
        return min(failed, 1)
    tally = Tally()
    reader = Reader(program)
    reader.read(known_inputs(), tally)
    reader.close()
    print(f"known inputs: {summary(tally)}", flush=True)
    failures = list(tally.failures)
    start = time.monotonic()
    tally = fuzz(program, options)
    print(f"seed {options.seed}, {time.monotonic() - start:.0f} s: {summary(tally)}", flush=True)
    kept = keep(program, [*failures, *tally.failures], options.out)
    (options.out / f"slowest.{tally.slowest[0]}").write_bytes(tally.slowest[1])
    print(f"{len(kept)} causes of failure")
    return 1 if kept else 0


if __name__ == "__main__":
    sys.exit(main())
