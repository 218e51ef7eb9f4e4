"""Signals, threads, forks, callbacks and memory."""

from __future__ import annotations

import multiprocessing
import os
import resource
import signal
import subprocess
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import abf_flatten as abf
import numpy as np
import pytest
from conftest import Mesh, bumpy

HERE = Path(__file__).parent
needs_fork = pytest.mark.skipif(not hasattr(os, "fork"), reason="this system cannot fork")


def flips(n: int) -> int:
    return abf.flatten(*bumpy(n)).certificate.flips


@needs_fork
def test_a_child_after_a_fork_works_and_so_do_its_children() -> None:
    flips(30)
    abf.flatten(*bumpy(30), threads=2)
    with multiprocessing.get_context("fork").Pool(2) as pool:
        assert pool.map_async(flips, [30] * 6).get(timeout=60) == [0] * 6
        assert pool.map_async(flips, [30] * 6).get(timeout=60) == [0] * 6
    assert flips(30) == 0


def test_spawned_processes_work() -> None:
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        assert pool.map_async(flips, [10]).get(timeout=60) == [0]


@needs_fork
def test_a_fork_while_other_threads_are_at_work_does_not_hang() -> None:
    vertices, faces = bumpy(150)
    with ThreadPoolExecutor(2) as threads:
        running = [threads.submit(abf.flatten, vertices, faces, threads=k) for k in (None, 1)]
        child = os.fork()
        if child == 0:
            code = 1
            try:
                code = flips(20)
            finally:
                os._exit(code)
        deadline = time.monotonic() + 60
        while (ended := os.waitpid(child, os.WNOHANG))[0] == 0:
            if time.monotonic() > deadline:
                os.kill(child, signal.SIGKILL)
                pytest.fail("the child hangs")
            time.sleep(0.01)
        assert os.waitstatus_to_exitcode(ended[1]) == 0
        assert all(run.result().certificate for run in running)


def test_several_threads_call_at_once_and_get_the_same() -> None:
    vertices, faces = bumpy(60)
    alone = abf.flatten(vertices, faces).uv
    with ThreadPoolExecutor(8) as threads:
        kinds = [None, 1, 2, None, 1, 1, 3, None]
        runs = [threads.submit(abf.flatten, vertices, faces, threads=k) for k in kinds]
        assert all(np.array_equal(run.result(timeout=60).uv, alone) for run in runs)


def test_the_lock_of_the_interpreter_is_released() -> None:
    ticks, stop = 0, threading.Event()

    def count() -> None:
        nonlocal ticks
        while not stop.wait(0.002):
            ticks += 1

    other = threading.Thread(target=count)
    other.start()
    begin = time.monotonic()
    abf.flatten(*bumpy(200))
    seconds = time.monotonic() - begin
    stop.set()
    other.join()
    assert ticks > seconds / 0.002 / 20, f"{ticks} in {seconds} s"


def test_two_calls_of_one_thread_each_run_at_the_same_time() -> None:
    together = threading.Barrier(2, timeout=60)

    def meet() -> bool:
        met = False

        def progress(_: abf.Progress) -> None:
            nonlocal met
            if not met:
                together.wait()
                met = True

        abf.flatten(*bumpy(150), threads=1, progress=progress)
        return met

    with ThreadPoolExecutor(2) as threads:
        assert all(run.result(timeout=120) for run in [threads.submit(meet) for _ in range(2)])


@pytest.mark.skipif(sys.platform == "win32", reason="no SIGINT to one process")
@pytest.mark.parametrize(
    ("most", "solvers"),
    [
        (0.2, ["auto", "linabf", "abf-fixed-target"]),
        # Single factorisations cannot be interrupted: docs/performance.md.
        (0.6, ["descent", "relax"]),
    ],
)
def test_ctrl_c_ends_a_call_soon(most: float, solvers: list[str]) -> None:
    """100 000 triangles: so many seconds of processor time after the signal, of this process alone."""
    command = [sys.executable, str(HERE / "interrupt.py"), "224", "0.1", *solvers]
    ran = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)
    assert ran.returncode == 0, ran.stdout + ran.stderr
    seconds = [line.split()[-1] for line in ran.stdout.splitlines()]
    assert sum(word != "None" for word in seconds[:-1]) >= len(solvers), "no signal came in time"
    assert float(seconds[-1]) < most, ran.stdout


def test_what_a_callback_raises_ends_the_call() -> None:
    class Enough(Exception):
        pass

    def progress(_: abf.Progress) -> None:
        raise Enough

    begin = time.process_time()
    for threads in (None, 1):
        with pytest.raises(Enough):
            abf.flatten(*bumpy(300), progress=progress, threads=threads)
    with pytest.raises(Enough):
        abf.unwrap(*bumpy(100), progress=progress)
    mesh = bumpy(200)
    with pytest.raises(Enough):
        abf.relax(mesh[0], mesh[1], mesh[0][:, :2], progress=progress)
    assert time.process_time() - begin < 60
    assert flips(30) == 0


def test_progress_is_told_where_the_call_was_made() -> None:
    heard: list[abf.Progress] = []
    where: set[int] = set()

    def progress(news: abf.Progress) -> None:
        heard.append(news)
        where.add(threading.get_ident())

    vertices, faces = bumpy(250)
    abf.flatten(vertices, faces, progress=progress)
    assert where == {threading.get_ident()}
    assert (heard[-1].stage, heard[-1].done, heard[-1].total) == ("done", len(faces), len(faces))
    assert {news.stage for news in heard} >= {"solve", "done"}
    assert any(news.iteration > 0 and news.residual < 1 for news in heard)


def test_progress_of_an_atlas_counts_faces() -> None:
    parts = [bumpy(60) for _ in range(6)]
    vertices = np.concatenate([v + [2 * k, 0, 0] for k, (v, _) in enumerate(parts)])
    faces = np.concatenate([f + 3600 * k for k, (_, f) in enumerate(parts)])
    heard: list[abf.Progress] = []
    abf.unwrap(vertices, faces, progress=heard.append)
    done = [news.done for news in heard]
    assert done == sorted(done) and done[-1] == len(faces) == heard[-1].total
    assert any(0 < count < len(faces) for count in done)


def test_a_callback_may_call_again(disk: Mesh) -> None:
    inner: list[bool] = []

    def progress(_: abf.Progress) -> None:
        if not inner:
            inner.append(bool(abf.flatten(*disk).certificate))

    abf.flatten(*disk, progress=progress)
    abf.flatten(*disk, progress=progress, threads=1)
    assert inner == [True]


def test_memory_does_not_grow_over_10_000_calls() -> None:
    vertices, faces = bumpy(5)
    corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    closed = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]

    def calls(count: int) -> None:
        for k in range(count):
            abf.flatten(vertices, faces, threads=1 + k % 3 if k % 2 else None)
            if k % 10 == 0:
                abf.unwrap(corners, closed, pack="fast", progress=lambda _: None)
                with pytest.raises(abf.NotADiskError):
                    abf.flatten(corners, closed)

    calls(1000)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    calls(10_000)
    grown = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before
    assert grown < 4096, f"{grown} kB"


def test_at_a_million_triangles_the_way_in_and_out_takes_less_than_2_percent() -> None:
    vertices, faces = bumpy(708)

    def seconds(max_memory: int | None) -> float:
        begin = time.process_time()
        try:
            flat = abf.flatten(vertices, faces, solver="linabf", passes=1, max_memory=max_memory)
            assert flat.uv.shape == (len(vertices), 2)
        except MemoryError:
            assert max_memory == 1
        return time.process_time() - begin

    # Refused after the arrays have been taken in, and before anything is done with them. Nothing is copied on the way out.
    way_in = sorted(seconds(1) for _ in range(7))[3]
    assert way_in < 0.02 * seconds(None)


@pytest.mark.skipif(not Path("/proc/self/task").is_dir(), reason="threads cannot be counted here")
def test_threads_do_not_pile_up() -> None:
    for threads in range(1, 40):
        abf.flatten(*bumpy(5), threads=threads)
    with ThreadPoolExecutor(16) as many:
        list(many.map(lambda _: abf.flatten(*bumpy(20), threads=8), range(64)))
    deadline = time.monotonic() + 20
    while (count := len(os.listdir("/proc/self/task"))) > 64 + 16 + (os.cpu_count() or 1):
        assert time.monotonic() < deadline, f"{count} threads"
        time.sleep(0.05)


def test_an_interpreter_ends_while_a_daemon_thread_is_at_work() -> None:
    code = (
        "import sys, threading, time; sys.path.insert(0, sys.argv[1])\n"
        "from conftest import bumpy; import abf_flatten\n"
        "threading.Thread(target=abf_flatten.flatten, args=bumpy(400), daemon=True).start(); time.sleep(0.3)"
    )
    ran = subprocess.run([sys.executable, "-c", code, HERE], capture_output=True, text=True, timeout=60, check=False)
    assert ran.returncode == 0, ran.stderr
