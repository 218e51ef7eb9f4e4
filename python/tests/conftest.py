"""Meshes that are made by code."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

Mesh = tuple[NDArray[np.float64], NDArray[np.int64]]


def bumpy(n: int) -> Mesh:
    """A bumpy sheet of n × n vertices, 2 (n - 1)² triangles: a disk."""
    x, y = np.meshgrid(np.linspace(0, 1, n), np.linspace(0, 1, n), indexing="ij")
    vertices = np.stack([x, y, 0.15 * np.sin(7 * x) * np.cos(5 * y)], -1).reshape(-1, 3)
    i = np.arange(n * n).reshape(n, n)
    a, b, c, d = (k.reshape(-1) for k in (i[:-1, :-1], i[1:, :-1], i[1:, 1:], i[:-1, 1:]))
    return vertices, np.concatenate([np.stack([a, b, c], -1), np.stack([a, c, d], -1)])


def torus(n: int, m: int) -> Mesh:
    """A closed surface with a handle."""
    u, v = np.meshgrid(np.arange(n) * 2 * np.pi / n, np.arange(m) * 2 * np.pi / m, indexing="ij")
    ring = 1 + 0.4 * np.cos(v)
    vertices = np.stack([ring * np.cos(u), ring * np.sin(u), 0.4 * np.sin(v)], -1).reshape(-1, 3)
    i = np.arange(n * m).reshape(n, m)
    right, up, both = np.roll(i, -1, 0), np.roll(i, -1, 1), np.roll(i, (-1, -1), (0, 1))
    a, b, c, d = (k.reshape(-1) for k in (i, right, both, up))
    return vertices, np.concatenate([np.stack([a, b, c], -1), np.stack([a, c, d], -1)])


@pytest.fixture
def disk() -> Mesh:
    return bumpy(20)


@pytest.fixture
def ring() -> Mesh:
    return torus(24, 12)
