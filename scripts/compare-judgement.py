"""Compares one flattened OBJ, judged by an independent script, with what the program's JSON says of it.

    compare-judgement.py JUDGE.py out.obj out.json LABEL
"""
import importlib.util
import json
import math
import sys

TOLERANCE = 1e-6
# Below this, squared angle differences are rounding and have no digits to compare.
ROUNDING = 1e-20
PAIRS = {"f": "mse_angle", "f_weighted": "wmse_angle", "stretch_l2": "l2_stretch", "stretch_linf": "linf_stretch"}

judge_path, obj, report, label = sys.argv[1:5]
spec = importlib.util.spec_from_file_location("judge", judge_path)
judge = importlib.util.module_from_spec(spec)
spec.loader.exec_module(judge)

theirs = judge.metrics_of_file(obj)
with open(report) as file:
    ours = json.load(file)["results"][0]

misses = []
for mine, other in PAIRS.items():
    a, b = ours[mine], theirs[other]
    a = math.inf if a is None else a
    if a == b or (abs(a) < ROUNDING and abs(b) < ROUNDING):
        continue
    if not abs(a / b - 1) <= TOLERANCE:
        misses.append(f"{mine} {a} is not {other} {b}")
# Ours decides flips exactly; the judge counts what lies within rounding apart.
mine = ours["flips"] + ours["collapsed"] + ours["near_collapsed"]
other = theirs["flipped"] + theirs["degenerate_uv"]
if mine != other:
    misses.append(f"{mine} flipped, collapsed and near-collapsed triangles are not {other}")

print(f"{label}: F {ours['f']:.6e}, {len(misses)} disagreements")
if misses:
    sys.exit(f"{label}: " + "; ".join(misses))
