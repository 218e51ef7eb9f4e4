"""Compares what `scripts/judge` says of a written file with what a report of the program says of it.

    compare-judgement.py out.obj out.json LABEL
"""
import json
import math
import pathlib
import subprocess
import sys

TOLERANCE = 1e-6
# Below this, squared angle differences are rounding and have no digits to compare.
ROUNDING = 1e-20
FIGURES = ["f", "f_weighted", "stretch_l2", "stretch_linf"]
COUNTS = {"flips": "flipped", "collapsed": "collapsed", "wound": "wound", "charts": "charts"}

written, report, label = sys.argv[1:4]
judge = pathlib.Path(__file__).with_name("judge")
# 1 is a file that cannot be judged; the JSON says why.
said = subprocess.run([sys.executable, judge, written], capture_output=True, text=True)
if not said.stdout:
    sys.exit(f"{label}: {said.stderr}")
theirs = json.loads(said.stdout)
if "error" in theirs:
    sys.exit(f"{label}: {theirs['error']}")
with open(report) as file:
    ours = json.load(file)["results"][0]

misses = []
for name in FIGURES:
    a, b = ours[name], theirs[name]
    if a is None and ours["near_collapsed"] > 0:
        # Infinite here, and as far as doubles carry there.
        continue
    a, b = (math.inf if x is None else x for x in (a, b))
    if a == b or (abs(a) < ROUNDING and abs(b) < ROUNDING):
        continue
    if not abs(a / b - 1) <= TOLERANCE:
        misses.append(f"{name} {a} is not {b}")
for mine, other in COUNTS.items():
    if ours[mine] != theirs[other]:
        misses.append(f"{mine} {ours[mine]} is not {other} {theirs[other]}")
# Overlaps mean something in valid maps only.
if theirs["valid"] and (ours["overlaps"] > 0) != (theirs["overlaps"] > 0):
    misses.append(f"overlaps {ours['overlaps']} is not {theirs['overlaps']}")

print(f"{label}: F {ours['f']:.6e}, {len(misses)} disagreements")
if misses:
    sys.exit(f"{label}: " + "; ".join(misses))
