"""Every mesh of a folder in turn on several threads, with a bar: broken files are rows with their error.

Needs: tqdm

    python many_files.py [FOLDER]
"""

import pathlib
import sys
from concurrent.futures import ThreadPoolExecutor

import abf_flatten
from tqdm import tqdm

folder = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".") / "many"
folder.mkdir(parents=True, exist_ok=True)
corners, faces = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]
for number in range(20):
    abf_flatten.write(folder / f"{number}.obj", [[x * (number + 1), y, z] for x, y, z in corners], faces)
(folder / "broken.obj").write_text("v 0 0 zero\n")


def row(path: pathlib.Path) -> dict:
    """What is known of one file. One thread each: the interpreter's lock is released."""
    try:
        mesh = abf_flatten.read(path)
        flat = abf_flatten.unwrap(mesh.vertices, mesh.faces, threads=1)
        return {"file": path.name, "error": None, "charts": flat.charts, "valid": flat.certificate.valid}
    except (OSError, ValueError, MemoryError) as error:
        return {"file": path.name, "error": str(error), "charts": 0, "valid": False}


paths = sorted(folder.glob("*.obj"))
with ThreadPoolExecutor(2) as threads:
    rows = list(tqdm(threads.map(row, paths), total=len(paths)))
assert [row["file"] for row in rows if row["error"]] == ["broken.obj"]
assert all(row["valid"] for row in rows if not row["error"])

# One large mesh: the bar counts finished faces.
large = abf_flatten.read(folder / "0.obj")
with tqdm(total=len(large.faces)) as bar:
    abf_flatten.unwrap(large.vertices, large.faces, progress=lambda news: bar.update(news.done - bar.n))
    assert bar.n == len(large.faces)
print(f"{len(rows)} files, {sum(row['valid'] for row in rows)} valid")
