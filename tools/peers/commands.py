"""Calls of programs. Nothing but Python's own library is needed here."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from typing import Any


class PeersError(Exception):
    """What is wrong and what to do about it."""


@dataclass(frozen=True)
class Ended:
    """What a command printed and what it took."""

    text: str
    # By the clock, and of processors [s].
    wall_seconds: float
    cpu_seconds: float
    # The most memory that it held at a time [bytes].
    peak_bytes: int


def timed(*words: object, environment: dict[str, str] | None = None) -> Ended:
    """Runs a command that must succeed."""
    command = [str(word) for word in words]
    with tempfile.TemporaryFile("w+") as out, tempfile.TemporaryFile("w+") as error:
        start = time.monotonic()
        try:
            process = subprocess.Popen(command, stdout=out, stderr=error, env=os.environ | (environment or {}))
        except OSError as fault:
            raise PeersError(f"`{' '.join(command)}` cannot be started: {fault}") from fault
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        wall = time.monotonic() - start
        out.seek(0)
        error.seek(0)
        if process.returncode != 0:
            said = error.read().strip()[-2000:]
            raise PeersError(f"`{' '.join(command)}` ended with {process.returncode}: {said}")
        kilobytes = usage.ru_maxrss if sys.platform != "darwin" else usage.ru_maxrss / 1024
        return Ended(out.read(), wall, usage.ru_utime + usage.ru_stime, int(kilobytes * 1024))


def run(*words: object) -> str:
    """Standard output of a command that must succeed."""
    return timed(*words).text


def called(*words: object) -> Any:
    """The JSON that a command prints."""
    return json.loads(run(*words))


def progress(text: str) -> None:
    """A line on standard error, so that standard output holds results alone."""
    print(text, file=sys.stderr, flush=True)
