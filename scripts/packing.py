"""Outlines of charts as text, packed by abf-pack, and judged without it: for the checks of packing in this folder.

The judge finds every distance between outlines itself, and decides in rationals where rounding could matter.
"""
import collections
import fractions
import json
import math
import os
import subprocess

import harness

# Squared distances nearer to the squared margin than this part of it are computed in rationals.
NEAR = 1e-9


def packer(given=None):
    """The example that packs outlines: the one that is given, or brought up to date."""
    if given:
        return given
    command = ["cargo", "build", "--release", "--quiet", "--package", "abf-pack", "--example", "outlines"]
    subprocess.run(command, cwd=harness.ROOT, check=True)
    target = os.environ.get("CARGO_TARGET_DIR", harness.ROOT / "target")
    return f"{target}/release/examples/outlines"


def read(text):
    """Charts as lists of loops of points; with `p` lines, pairs of a page and a chart."""
    charts, pages = [], []
    for line in text.splitlines():
        words = line.split()
        if not words:
            continue
        if words[0] == "p":
            pages.append(int(words[1]))
        elif words[0] == "c":
            charts.append([])
        elif words[0] == "l":
            charts[-1].append([])
        else:
            charts[-1][-1].append((float(words[0]), float(words[1])))
    return list(zip(pages, charts)) if pages else charts


def written(charts):
    """Charts as text."""
    lines = []
    for loops in charts:
        lines.append(f"c {len(loops)}")
        for ring in loops:
            lines.append(f"l {len(ring)}")
            lines.extend(f"{x!r} {y!r}" for x, y in ring)
    return "\n".join(lines) + "\n"


def pack(binary, text, *options):
    """What the packer makes of outlines: pairs of a page and a chart in texels, and its figures."""
    ran = subprocess.run([binary, *options], input=text, capture_output=True, text=True, check=False)
    if ran.returncode != 0:
        raise RuntimeError(ran.stderr.strip())
    return read(ran.stdout), json.loads(ran.stderr)


def area(loops):
    """The outer loop without the others: the largest is the outer one."""
    def of(ring):
        return abs(sum(a[0] * b[1] - b[0] * a[1] for a, b in zip(ring, ring[1:] + ring[:1]))) / 2

    areas = [of(ring) for ring in loops]
    return 2 * max(areas) - sum(areas)


def edges(loops):
    """The edges of all loops."""
    return [(a, b) for ring in loops for a, b in zip(ring, ring[1:] + ring[:1])]


def squared_to_segment(p, a, b):
    """The squared distance of a point to a segment, in whatever numbers these have."""
    dx, dy = b[0] - a[0], b[1] - a[1]
    length = dx * dx + dy * dy
    t = ((p[0] - a[0]) * dx + (p[1] - a[1]) * dy) / length if length else length
    t = min(max(t, 0), 1)
    ex, ey = p[0] - a[0] - t * dx, p[1] - a[1] - t * dy
    return ex * ex + ey * ey


def turn(o, a, b):
    """Twice the signed area of a triangle."""
    return (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0])


def squared_distance(e, f):
    """The squared distance of two segments, in whatever numbers these have."""
    (a, b), (c, d) = e, f
    if turn(a, b, c) * turn(a, b, d) < 0 and turn(c, d, a) * turn(c, d, b) < 0:
        return 0
    ends = [(a, c, d), (b, c, d), (c, a, b), (d, a, b)]
    return min(squared_to_segment(*three) for three in ends)


def rational(points):
    """Points as exact numbers."""
    return tuple(tuple(fractions.Fraction(x) for x in p) for p in points)


def is_nearer(e, f, margin):
    """Whether two segments are nearer than the margin, decided exactly."""
    found, limit = squared_distance(e, f), margin * margin
    if abs(found - limit) > NEAR * max(limit, 1.0):
        return found < limit
    return squared_distance(rational(e), rational(f)) < fractions.Fraction(margin) ** 2


def is_inside(p, loops):
    """Whether a point is inside an odd number of loops."""
    inside = False
    for a, b in edges(loops):
        if (a[1] <= p[1]) != (b[1] <= p[1]):
            inside ^= a[0] + (p[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0]) > p[0]
    return inside


def box(loops):
    """The least and the greatest coordinates."""
    xs, ys = zip(*(p for ring in loops for p in ring))
    return min(xs), min(ys), max(xs), max(ys)


def faults(placed, page, margin):
    """What is wrong with charts on pages of `page` texels, in words: nothing, if the margin holds everywhere."""
    found = []
    squares = collections.defaultdict(list)
    side = max(4.0, 2.0 * margin)
    boxes = [box(loops) for _, loops in placed]
    for i, (number, loops) in enumerate(placed):
        low_x, low_y, high_x, high_y = boxes[i]
        room = min(low_x, low_y, page[0] - high_x, page[1] - high_y)
        if room < margin:
            found.append(f"chart {i} is {room} texels from the border")
        near = set()
        for (a, b) in edges(loops):
            for square in squares_of(a, b, side):
                for wide_x in (-1, 0, 1):
                    for wide_y in (-1, 0, 1):
                        near.update(squares.get((number, square[0] + wide_x, square[1] + wide_y), ()))
                    # An edge is looked at from each of its squares: a set keeps it one.
            for j, other in near:
                if is_nearer((a, b), other, margin):
                    found.append(f"charts {i} and {j} are {math.sqrt(squared_distance((a, b), other))} texels apart")
                    return found
            near.clear()
        for (a, b) in edges(loops):
            for square in squares_of(a, b, side):
                squares[(number, *square)].append((i, (a, b)))
    found.extend(nested(placed, boxes))
    return found


def squares_of(a, b, side):
    """The squares that an edge passes, and a few beside it: row by row."""
    (low, high) = (a, b) if a[1] <= b[1] else (b, a)
    first, last = math.floor(low[1] / side), math.floor(high[1] / side)
    for row in range(first, last + 1):
        ends = []
        for y in (max(low[1], row * side), min(high[1], (row + 1) * side)):
            t = (y - low[1]) / (high[1] - low[1]) if high[1] > low[1] else 0.0
            ends.append(low[0] + t * (high[0] - low[0]))
        if high[1] == low[1]:
            ends = [low[0], high[0]]
        for column in range(math.floor(min(ends) / side - 1e-9), math.floor(max(ends) / side + 1e-9) + 1):
            yield column, row


def nested(placed, boxes):
    """Charts that lie in the solid part of another one."""
    order = sorted(range(len(placed)), key=lambda i: boxes[i][0])
    for at, i in enumerate(order):
        for j in order[at:]:
            if boxes[j][0] > boxes[i][2]:
                break
            for inner, outer in ((i, j), (j, i)):
                p = placed[inner][1][0][0]
                x0, y0, x1, y1 = boxes[outer]
                is_apart = i == j or placed[i][0] != placed[j][0] or not (x0 <= p[0] <= x1 and y0 <= p[1] <= y1)
                if not is_apart and is_inside(p, placed[outer][1]):
                    yield f"chart {inner} lies in the solid part of chart {outer}"
