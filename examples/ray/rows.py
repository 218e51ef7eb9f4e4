"""What a worker does: from the bytes of a file to a row of Parquet."""

import fcntl
import functools
import os
import time

import numpy as np
import pyarrow as pa

EXTENSIONS = ["obj", "off", "ply", "stl", "glb", "gltf"]
#: A lock that every process keeps which writes rows, as long as it lives.
WRITERS = "writers.lock"
NUMBERS = {
    "triangles": pa.int64(),
    "valid": pa.bool_(),
    "injective": pa.bool_(),
    "certified": pa.bool_(),
    "charts": pa.int32(),
    "flips": pa.int64(),
    "overlaps": pa.int64(),
    "stretch_l2": pa.float64(),
    "angle_error": pa.float64(),
    "coverage": pa.float64(),
    "read_s": pa.float64(),
    "cpu_s": pa.float64(),
}
TEXTS = ("path", "error", "solver", "termination", "repairs")
#: Of an atlas its three arrays, row by row; of a disk `uvs` alone.
ARRAYS = {"vmapping": np.uint32, "indices": np.uint32, "uvs": np.float64}


def row_of(path, data, options):
    """What becomes of one file. The arrays of a result are in it as they are."""
    import abf_flatten

    begin = time.process_time()
    row = {"path": path}
    try:
        mesh = abf_flatten.parse(os.path.basename(path), data)
        read = time.process_time()
        row |= {"triangles": len(mesh.faces), "read_s": read - begin}
        # A worker has one core: the other ones belong to other workers.
        common = {"solver": options.solver, "threads": 1, "max_memory": options.max_memory}
        if options.task == "flatten":
            flat = abf_flatten.flatten(mesh.vertices, mesh.faces, **common)
            row |= {"solver": flat.solver, "termination": flat.termination, "charts": 1, "uvs": flat.uv}
        else:
            flat = abf_flatten.unwrap(
                mesh.vertices, mesh.faces, max_stretch=options.max_stretch, resolution=options.resolution, **common
            )
            row |= {"charts": flat.charts, "coverage": flat.coverage, "repairs": "; ".join(flat.repairs)}
            row |= {"vmapping": flat.vmapping, "indices": flat.indices, "uvs": flat.uvs}
        known = flat.certificate
        row |= {"valid": known.valid, "injective": known.injective, "certified": flat.certified}
        row |= {"flips": known.flips, "overlaps": known.overlaps}
        row |= {"stretch_l2": flat.metrics.stretch_l2, "angle_error": flat.metrics.f}
        row["cpu_s"] = time.process_time() - read
    except (ValueError, MemoryError) as error:
        row["error"] = f"{type(error).__name__}: {error}"
    return row


def table_of(rows, with_arrays):
    """Rows as Arrow has them. Lists are made of whole arrays: of single numbers they would take forty times as long."""
    columns = {name: pa.array([row.get(name) for row in rows], pa.string()) for name in TEXTS}
    columns |= {name: pa.array([row.get(name) for row in rows], kind) for name, kind in NUMBERS.items()}
    for name, dtype in ARRAYS.items() if with_arrays else ():
        arrays = [np.asarray(row.get(name, ()), dtype).ravel() for row in rows]
        ends = np.cumsum([0, *map(len, arrays)])
        columns[name] = pa.LargeListArray.from_arrays(ends, np.concatenate(arrays) if arrays else np.zeros(0, dtype))
    return pa.table(columns)


@functools.cache
def keep_lock(out):
    """Says as long as this process lives that it may write to `out`."""
    lock = open(os.path.join(out, WRITERS), "a")  # noqa: SIM115
    fcntl.flock(lock, fcntl.LOCK_SH)
    return lock


def work(batch, options):
    """A batch of files, as Ray hands it over."""
    keep_lock(options.out)
    files = zip(batch["path"].to_pylist(), batch["bytes"].to_pylist())
    return table_of([row_of(path, data, options) for path, data in files], options.arrays)
