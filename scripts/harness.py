"""Runs the program for the checks in this folder."""
import json
import os
import pathlib
import resource
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
DATA = ROOT / "crates/bench-harness/data"


def models():
    """The folder that ABF_MODELS names, or None; one that is none ends the check."""
    folder = os.environ.get("ABF_MODELS")
    if folder and not os.path.isdir(folder):
        sys.exit(f"ABF_MODELS names {folder}, which is not a folder")
    return pathlib.Path(folder).resolve() if folder else None


def program(given):
    """The program to check: the one given, else the release build, brought up to date."""
    if given:
        return given.resolve()
    subprocess.run(["cargo", "build", "--release", "--quiet", "--package", "bench-harness"], cwd=ROOT, check=True)
    return ROOT / "target/release/bench-harness"


def cpu():
    """The CPU seconds of all children so far."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def said():
    """This command and the commit, for the head of a table."""
    try:
        asked = subprocess.run(["git", "describe", "--always", "--dirty"], cwd=ROOT, capture_output=True, text=True, check=True)
        commit = asked.stdout.strip()
    except (OSError, subprocess.CalledProcessError):
        commit = "unknown"
    words = [word if word.startswith("-") else pathlib.Path(word).name for word in sys.argv[1:]]
    return f"`{' '.join([f'scripts/{pathlib.Path(sys.argv[0]).name}', *words])}`, commit {commit}"


def run(binary, arguments, meshes):
    """One result per mesh, as the program's JSON has them. RuntimeError: it did not get that far."""
    return run_with_code(binary, arguments, meshes)[0]


def run_with_code(binary, arguments, meshes, timeout=None):
    """The same with the exit code. subprocess.TimeoutExpired: it took more seconds than `timeout`."""
    command = [binary, *arguments, "--json", "-", *meshes]
    ran = subprocess.run(command, capture_output=True, text=True, check=False, timeout=timeout)
    try:
        results = json.loads(ran.stdout)["results"]
    except (ValueError, LookupError):
        raise RuntimeError(f"exit code {ran.returncode}: {ran.stderr.strip()[-400:]}") from None
    if len(results) != len(meshes):
        raise RuntimeError(f"{len(results)} results for {len(meshes)} meshes")
    return results, ran.returncode
