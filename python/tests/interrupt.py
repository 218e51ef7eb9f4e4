"""Sends itself SIGINT during a call, and prints how much processor time passes until the call ends.

    python interrupt.py SIDE SECONDS [SOLVER...]

SIDE² vertices; "relax" is `relax` of a map instead of a solver. The signal comes after a part of the time that the whole call takes, for several parts. The last word
printed is the worst.
"""

from __future__ import annotations

import os
import signal
import sys
import threading
import time
from typing import Any

import abf_flatten as abf
from conftest import bumpy


def latency(mesh: Any, solver: Any, after: float) -> float | None:
    """Seconds of processor time from the signal to its exception; None when the call ended before."""
    sent = [0.0]
    ended = threading.Event()
    base = time.process_time()

    def send() -> None:
        while time.process_time() - base < after:
            if ended.wait(0.001):
                return
        sent[0] = time.process_time()
        os.kill(os.getpid(), signal.SIGINT)

    other = threading.Thread(target=send)
    other.start()
    try:
        try:
            if solver == "relax":
                abf.relax(mesh[0], mesh[1], mesh[0][:, :2])
            else:
                abf.flatten(*mesh, solver=solver)
        except KeyboardInterrupt:
            return time.process_time() - sent[0]
        ended.set()
        other.join()
        # The signal may have come at the very end.
        time.sleep(0.05)
    except KeyboardInterrupt:
        pass
    finally:
        ended.set()
        other.join()
    return None


def main() -> None:
    # A job in the background of a shell ignores the signal.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    side, solvers = int(sys.argv[1]), sys.argv[3:] or ["linabf", "abf-fixed-target", "descent"]
    mesh = bumpy(side)
    worst = 0.0
    for solver in solvers:
        for part in range(1, 6):
            seconds = latency(mesh, solver, part * float(sys.argv[2]))
            print(solver, f"after {part * float(sys.argv[2]):.2f} s:", seconds, flush=True)
            worst = max(worst, seconds or 0.0)
    print("worst", worst)


if __name__ == "__main__":
    main()
