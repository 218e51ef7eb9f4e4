"""The names that settings take, and what progress is told to."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal, Optional, Union

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from ._results import Progress

Reals = NDArray[np.float64]
Indices = NDArray[np.int64]
#: Vertices, faces, UVs, and the rows of every corner.
Mapped = tuple[Reals, Indices, Reals, Optional[Indices]]
Solver = Literal[
    "auto",
    "linabf",
    "abf",
    "abf++",
    "abf-newton",
    "abf-fixed-target",
    "uzawa",
    "minres",
    "barrier",
    "descent",
    "habf++",
    "hlinabf",
    "lscm",
]
Layout = Literal["auto", "tree", "least-squares", "least-squares-weighted", "poisson"]
ZeroArea = Literal["carry", "refuse"]
Wheel = Literal["product", "log"]
Hessian = Literal["exact", "gauss-newton"]
LineSearch = Literal["merit", "full"]
Reduction = Literal["none", "triangles"]
Preconditioner = Literal["none", "jacobi", "block"]
Holes = Literal["auto", "fill", "fill-fan", "fill-ears", "cut", "free"]
Weld = Union[Literal["auto", "off"], float]
DoubleSided = Literal["own", "shared"]
Pages = Literal["one", "per-component", "per-material"]
Effort = Literal["fast", "good", "best"]
Precision = Literal["single", "double"]
InnerMargin = Literal["count", "keep"]
Overlap = Literal["refuse", "allow"]
#: What is to be little in a map; a number is the weight of areas beside angles.
Energy = Union[Literal["abf", "isometric", "usable"], float]
Injective = Literal["off", "split", "deform"]
#: Vertices with their places: (u, v), or (u, v, weight) where the place need not be met.
Pins = Mapping[int, Union[Sequence[float], NDArray[Any]]]
OnProgress = Callable[["Progress"], object]
