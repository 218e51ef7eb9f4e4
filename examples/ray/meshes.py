"""Unwraps or flattens every mesh of a folder with Ray Data. Each file is one row of Parquet, whatever became of it.

    pip install "ray[data]" abf-flatten
    python meshes.py MESHES OUT                        # atlases
    python meshes.py MESHES OUT --task flatten         # disks, whole

* A file that is broken, or takes too much memory, is a row with its error.
* Started again after any end, even kill -9, it goes on: what is in OUT is not done twice.
* One driver at a time writes to OUT. A second one is refused.

MESHES and OUT are seen by all machines of the cluster, under one name, with locks that reach from one to the other (NFS 4).
docs/scale.md says what this is for, and what it is not for.
"""

import argparse
import fcntl
import functools
import os
import pathlib
import sys

import pyarrow.dataset

import rows


def take_locks(out):
    """Makes this the only driver, and waits for workers of one that was killed: they live on for a moment."""
    driver = open(out / "driver.lock", "a")  # noqa: SIM115
    try:
        fcntl.flock(driver, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        sys.exit(f"another driver writes to {out}: wait for it, or end it")
    with open(out / rows.WRITERS, "a") as writers:
        fcntl.flock(writers, fcntl.LOCK_EX)
    return driver


def run(options):
    import ray
    from ray.data import DataContext
    from ray.data.checkpoint import CheckpointConfig

    # A core of this machine per worker; of a cluster that is there, all that it has.
    cluster = {"address": options.address} if options.address else {"num_cpus": options.workers}
    # rows.py goes to every machine.
    here = {"working_dir": os.path.dirname(os.path.abspath(__file__)), "excludes": ["__pycache__"]}
    ray.init(**cluster, runtime_env=here, include_dashboard=False, log_to_driver=False)
    context = DataContext.get_current()
    context.enable_progress_bars = sys.stderr.isatty()
    # A file's row and that it is done are kept together: Ray undoes a block of which only one was written.
    context.checkpoint_config = CheckpointConfig(
        id_column="path", checkpoint_path=os.path.join(options.out, "checkpoint"), delete_checkpoint_on_success=False
    )
    files = ray.data.read_binary_files(
        options.meshes, include_paths=True, file_extensions=rows.EXTENSIONS, override_num_blocks=options.blocks
    )
    told = functools.partial(rows.work, options=options)
    # Who computes rows writes them, too, as long as nothing else is said of the workers. One that is killed is replaced, and its
    # block is done again.
    done = files.map_batches(told, batch_format="pyarrow", batch_size=options.batch)
    done.write_parquet(os.path.join(options.out, "rows"))
    ray.shutdown()


def report(options):
    """Says what is there. Exit code 1: rows are missing or doubled."""
    here = [path for path in pathlib.Path(options.meshes).rglob("*") if path.suffix[1:].lower() in rows.EXTENSIONS]
    names = ["path", "error", "valid", "triangles", "cpu_s"]
    there = pyarrow.dataset.dataset(os.path.join(options.out, "rows"), format="parquet").to_table(columns=names).to_pydict()
    count, distinct = len(there["path"]), len(set(there["path"]))
    failed = [(path, error) for path, error in zip(there["path"], there["error"]) if error]
    triangles, seconds = sum(filter(None, there["triangles"])), sum(filter(None, there["cpu_s"]))
    for path, error in sorted(failed)[:10]:
        print(f"{path}: {error}")
    print(f"{count} rows of {len(here)} files, {distinct} distinct, {sum(map(bool, there['valid']))} valid, {len(failed)} failed")
    print(f"{triangles} triangles in {seconds:.1f} CPU seconds")
    return 0 if count == distinct == len(here) else 1


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("meshes", metavar="MESHES", help="a folder, with all that is in it")
    parser.add_argument("out", metavar="OUT", help="where rows, checkpoint and locks go")
    parser.add_argument("--task", choices=["unwrap", "flatten"], default="unwrap")
    parser.add_argument("--solver", default="auto")
    parser.add_argument("--max-stretch", type=float, default=1.15)
    parser.add_argument("--resolution", type=int, default=1024)
    parser.add_argument("--max-memory", type=int, default=4_000_000_000, help="bytes for one mesh; more is a row with an error")
    parser.add_argument("--workers", type=int, help="processes on this machine [one per core]")
    parser.add_argument("--address", help="a cluster that is there, such as auto, instead of this machine")
    parser.add_argument("--batch", type=int, default=8, help="files that a worker takes at a time")
    parser.add_argument("--blocks", type=int, help="parts that the files are read in [Ray's choice]")
    parser.add_argument("--no-arrays", dest="arrays", action="store_false", help="rows without UVs and indices")
    options = parser.parse_args()
    options.meshes, options.out = os.path.abspath(options.meshes), os.path.abspath(options.out)
    out = pathlib.Path(options.out)
    out.mkdir(parents=True, exist_ok=True)
    driver = take_locks(out)
    run(options)
    code = report(options)
    driver.close()
    return code


if __name__ == "__main__":
    sys.exit(main())
