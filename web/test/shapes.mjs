// Small meshes, and meshes from OBJ files of triangles.
import { readFileSync } from "node:fs";

export const cube = {
  positions: new Float32Array([0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 0, 1, 1, 0, 1, 0, 1, 1, 1, 1, 1]),
  indices: new Uint32Array([
    0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5,
  ]),
};

/** A torus of around by across quads. */
export function torus(around, across) {
  const positions = [];
  const indices = [];
  for (let i = 0; i < around; ++i) {
    for (let j = 0; j < across; ++j) {
      const [a, b] = [(2 * Math.PI * i) / around, (2 * Math.PI * j) / across];
      const r = 2 + Math.cos(b);
      positions.push(r * Math.cos(a), r * Math.sin(a), Math.sin(b));
      const at = (p, q) => (p % around) * across + (q % across);
      const [p, q, s, t] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
      indices.push(p, q, s, p, s, t);
    }
  }
  return { positions: new Float32Array(positions), indices: new Uint32Array(indices) };
}

/** A bumpy square of n by n quads: a disk. */
export function sheet(n) {
  const positions = [];
  const indices = [];
  for (let i = 0; i <= n; ++i) {
    for (let j = 0; j <= n; ++j) {
      positions.push(i / n, j / n, 0.15 * Math.sin((7 * i) / n) * Math.cos((5 * j) / n));
      if (i === n || j === n) continue;
      const a = i * (n + 1) + j;
      indices.push(a, a + n + 1, a + n + 2, a, a + n + 2, a + 1);
    }
  }
  return { positions: new Float64Array(positions), indices: new Uint32Array(indices) };
}

/** A narrow road of n quads along and two across that climbs around an axis: a disk, which lies over itself beyond one turn. */
export function ramp(turns, rise = 0.3, n = 60) {
  const [positions, indices] = [[], []];
  for (let i = 0; i <= n; ++i) {
    const angle = (2 * Math.PI * turns * i) / n;
    for (const r of [4, 4.5, 5]) positions.push(r * Math.cos(angle), r * Math.sin(angle), rise * angle);
    if (i < n) for (const a of [3 * i, 3 * i + 1]) indices.push(a, a + 1, a + 4, a, a + 4, a + 3);
  }
  return { positions: new Float64Array(positions), indices: new Uint32Array(indices) };
}

export function obj(file) {
  const positions = [];
  const indices = [];
  for (const line of readFileSync(file, "utf8").split("\n")) {
    const words = line.trim().split(/\s+/);
    if (words[0] === "v") positions.push(...words.slice(1, 4).map(Number));
    if (words[0] === "f") indices.push(...words.slice(1, 4).map((word) => Number.parseInt(word, 10) - 1));
  }
  return { positions: new Float64Array(positions), indices: new Uint32Array(indices) };
}
