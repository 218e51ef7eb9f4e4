// The npm package in Node, against the program in $ABF_PROGRAM.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { existsSync, readFileSync } from "node:fs";
import { join } from "node:path";
import test from "node:test";
import * as abf from "../package/index.js";
import { cube, obj, ramp, sheet, torus } from "./shapes.mjs";

const root = join(import.meta.dirname ?? new URL(".", import.meta.url).pathname, "../..");
const engine = await abf.load();

/** What the program says of a file. */
function native(file, ...options) {
  const said = execFileSync(process.env.ABF_PROGRAM, [file, ...options, "--json", "-"], { maxBuffer: 1 << 28, stdio: ["ignore", "pipe", "ignore"] });
  return JSON.parse(said).results[0];
}

test("flatten agrees with the program to seven digits", () => {
  const models = process.env.ABF_MODELS;
  const files = ["mask", "hemisphere", "wavy-saddle", "twisted-band"].map((name) => join(root, "fixtures", `${name}.obj`));
  if (models) files.push(...["paper/cow.obj", "paper/horse.obj", "paper/gargoyle.obj"].map((name) => join(models, name)));
  else console.log("ABF_MODELS is not set: 3 models are skipped");
  for (const file of files) {
    for (const solver of ["linabf", "auto"]) {
      const { positions, indices } = obj(file);
      const flat = engine.flatten(positions, indices, { solver });
      const said = native(file, "--solver", solver);
      assert.ok(Math.abs(flat.angleError / said.f - 1) < 1e-7, `${file} ${solver}: ${flat.angleError} and ${said.f}`);
      assert.equal(flat.valid, said.valid);
      assert.equal(flat.uv.length, (positions.length / 3) * 2);
    }
  }
});

test("a cube and a torus become atlases whose triangles keep their order", async () => {
  for (const { positions, indices } of [cube, torus(48, 24)]) {
    const atlas = await abf.unwrap(positions, indices, { resolution: 512, margin: 4 });
    assert.ok(atlas.certified && atlas.injective && atlas.stretchL2 < 1.15);
    assert.deepEqual(Uint32Array.from(atlas.indices, (vertex) => atlas.remap[vertex]), indices);
    assert.equal(atlas.uvs.length, 2 * atlas.remap.length);
    assert.ok(atlas.uvs.every((x) => x >= 0 && x <= 1));
    assert.deepEqual([atlas.width, atlas.height, atlas.pageCount], [512, 512, 1]);
    assert.ok(atlas.triangleCharts.every((chart) => chart < atlas.chartCount));
  }
});

test("seams, materials and UVs decide where charts end", () => {
  const { positions, indices } = cube;
  const charts = (options) => engine.unwrap(positions, indices, options).chartCount;
  const around = [0, 1, 1, 3, 3, 2, 2, 0];
  const materials = Uint8Array.from({ length: 12 }, (_, triangle) => Math.floor(triangle / 2));
  assert.deepEqual([charts({}), charts({ seams: around }), charts({ materials }), charts({ materials, seams: "keep" })], [1, 2, 1, 6]);
  assert.equal(engine.unwrap(positions, indices, { materials, atlas: "per-material" }).pageCount, 6);
  const known = engine.unwrap(positions, indices, { materials, seams: "keep" });
  const again = { uv: known.uvs, uvIndices: known.indices, seams: "keep" };
  assert.equal(charts(again), 6);
  // A flat strip along a half circle covers little of a page.
  const strip = ramp(0.5, 0, 48);
  const parted = engine.unwrap(strip.positions, strip.indices, { coverage: 0.6, seamBudget: 0.5 });
  assert.equal(parted.chartCount, 1 + parted.partedForCoverage);
  assert.ok(parted.partedForCoverage > 0 && parted.injective);
});

test("a boundary is what was asked for, by its name and by its angles", () => {
  const [n, right] = [12, Math.PI / 2];
  const { positions, indices } = sheet(n - 1);
  const corners = [0, n - 1, n * n - 1, n * n - n];
  const named = engine.flatten(positions, indices, { boundary: `rectangle=${corners}` });
  assert.ok(named.injective);
  const angle = (uv, at, a, b) => {
    const [p, q] = [a, b].map((end) => [uv[2 * end] - uv[2 * at], uv[2 * end + 1] - uv[2 * at + 1]]);
    return Math.acos((p[0] * q[0] + p[1] * q[1]) / Math.hypot(...p) / Math.hypot(...q));
  };
  assert.ok(Math.abs(angle(named.uv, 0, 1, n) - right) < 1e-4);
  for (const boundary of [new Map([[0, right]]), { 0: right }]) {
    const given = engine.flatten(positions, indices, { boundary });
    assert.ok(Math.abs(angle(given.uv, 0, 1, n) - right) < 1e-4);
  }
});

test("an energy is less after relaxing, and pins are met or said to be missed", () => {
  const { positions, indices } = sheet(20);
  const steep = positions.map((x, at) => (at % 3 === 2 ? 6 * x : x));
  const plain = engine.flatten(steep, indices);
  assert.deepEqual([plain.relaxSteps, plain.pinDistances], [0, undefined]);
  for (const energy of ["usable", 0.5, "isometric"]) {
    const flat = engine.flatten(steep, indices, { energy });
    assert.ok(flat.certified && flat.relaxSteps > 0 && flat.energyAfter < flat.energyBefore && flat.stretchL2 < plain.stretchL2);
  }
  const start = engine.flatten(steep, indices, { solver: "lscm", normalize: true });
  const better = engine.relax(steep, indices, start.uv);
  assert.ok(better.certified && better.stretchL2 < start.stretchL2 && Math.abs(better.uvArea / start.uvArea - 1) < 1e-9);
  const corners = engine.relax(steep, indices, start.uv, { uvIndices: indices });
  for (let c = 0; c < indices.length; ++c) {
    assert.equal(corners.remap[corners.indices[c]], indices[c]);
    assert.equal(corners.uv[2 * corners.indices[c]], better.uv[2 * indices[c]]);
  }
  for (const pins of [{ 0: [1, 2], 5: [3, 2] }, new Map([[0, [1, 2]], [5, new Float32Array([3, 2])]])]) {
    const flat = engine.flatten(steep, indices, { pins });
    assert.deepEqual([...flat.uv.slice(0, 2), ...flat.uv.slice(10, 12), ...flat.pinDistances], [1, 2, 3, 2, 0, 0]);
  }
  const soft = engine.flatten(steep, indices, { pins: { 0: [1, 2], 5: [3, 2, 0.5] } });
  assert.ok(soft.pinsMissed === 0 && soft.pinDistances[1] > 0);
  const atlas = engine.unwrap(torus(24, 12).positions, torus(24, 12).indices, { energy: "isometric" });
  assert.ok(atlas.certified && atlas.relaxSteps > 0);
});

test("a map that lies over itself is left, parted or deformed, as was asked", () => {
  const { positions, indices } = ramp(1.3);
  const plain = engine.flatten(positions, indices);
  assert.ok(plain.valid && !plain.injective);
  assert.deepEqual(engine.flatten(positions, indices, { injective: "off" }).uv, plain.uv);
  const parted = engine.flatten(positions, indices, { injective: "split" });
  assert.ok(parted.injective && parted.certified && parted.remap.length > positions.length / 3);
  assert.deepEqual(Uint32Array.from(parted.indices, (row) => parted.remap[row]), indices);
  for (const boundaryGap of [0, 0.2]) {
    const whole = engine.flatten(positions, indices, { injective: "deform", boundaryGap });
    assert.ok(whole.injective && whole.certified && whole.uv.length === (positions.length / 3) * 2);
    assert.ok(whole.angleError > plain.angleError);
  }
  const refused = (error) => error instanceof abf.AbfError && error.message.length > 0;
  assert.throws(() => engine.flatten(positions, indices, { injective: "always" }), refused);
  assert.throws(() => engine.flatten(positions, indices, { boundaryGap: 0.2 }), refused);
});

test("arrays of any kind are taken, and a stride skips what lies between", () => {
  const { positions, indices } = cube;
  const expected = engine.unwrap(positions, indices);
  const plain = engine.unwrap([...positions], [...indices]);
  const short = engine.unwrap(Float64Array.from(positions), Uint16Array.from(indices));
  const apart = new Float32Array(8 * 5).fill(NaN);
  for (let v = 0; v < 8; ++v) apart.set(positions.subarray(3 * v, 3 * v + 3), 5 * v);
  const strided = engine.unwrap(apart, indices, { stride: 20 });
  for (const other of [plain, short, strided]) assert.deepEqual(other.uvs, expected.uvs);
});

test("every wrong input has a class and a code", () => {
  const { positions, indices } = cube;
  const triangle = [new Float32Array([0, 0, 0, 1, 0, 0, 0, 1, 0]), [0, 1, 2]];
  const cases = [
    [() => engine.unwrap(positions, indices.subarray(1)), abf.AbfInputError, "index-count"],
    [() => engine.unwrap(positions, [0, 1, 8]), abf.AbfInputError, "index-range"],
    [() => engine.unwrap(positions, [0, 1, -1]), abf.AbfInputError, "index-range"],
    [() => engine.unwrap(positions, [0, 1, 1.5]), abf.AbfInputError, "index-range"],
    [() => engine.unwrap(positions.subarray(1), indices), abf.AbfInputError, "input"],
    [() => engine.unwrap("positions", indices), abf.AbfInputError, "input"],
    [() => engine.unwrap([0, 0, NaN, 1, 0, 0, 0, 1, 0], [0, 1, 2]), abf.AbfInputError, "not-finite"],
    [() => engine.unwrap(positions, indices, { stride: 10 }), abf.AbfInputError, "stride"],
    [() => engine.unwrap(positions, indices, { solver: "abc" }), abf.AbfSettingError, "setting"],
    [() => engine.unwrap(positions, indices, { maxstretch: 2 }), abf.AbfSettingError, "setting"],
    [() => engine.unwrap(positions, indices, { resolution: -1 }), abf.AbfSettingError, "setting"],
    [() => engine.unwrap(positions, indices, { timeLimit: 0 }), abf.AbfSettingError, "setting"],
    [() => engine.unwrap(positions, indices, { normalize: true }), abf.AbfSettingError, "setting"],
    [() => engine.unwrap(positions, indices, { boundary: "circle" }), abf.AbfSettingError, "setting"],
    [() => engine.flatten(...triangle, { boundary: "oval" }), abf.AbfSettingError, "setting"],
    [() => engine.flatten(...triangle, { boundary: { 7: 1 } }), abf.AbfSettingError, "setting"],
    [() => engine.flatten(...triangle, { boundary: { x: 1 } }), abf.AbfInputError, "index-range"],
    [() => engine.flatten(...triangle, { energy: "little" }), abf.AbfSettingError, "setting"],
    [() => engine.flatten(...triangle, { energy: 0 }), abf.AbfSettingError, "setting"],
    [() => engine.flatten(...triangle, { energy: "usable", boundary: "convex" }), abf.AbfSettingError, "setting"],
    [() => engine.flatten(...triangle, { pins: { 0: [1] } }), abf.AbfInputError, "input"],
    [() => engine.flatten(...triangle, { pins: { 0: 1 } }), abf.AbfInputError, "input"],
    [() => engine.flatten(...triangle, { pins: { x: [1, 2] } }), abf.AbfInputError, "index-range"],
    [() => engine.flatten(...triangle, { pins: { 7: [1, 2] } }), abf.AbfSettingError, "setting"],
    [() => engine.flatten(...triangle, { pins: { 0: [1, 2, 0] } }), abf.AbfSettingError, "setting"],
    [() => engine.flatten(...triangle, { pins: { 0: [1, NaN] } }), abf.AbfSettingError, "setting"],
    [() => engine.flatten(...triangle, { pins: { 0: [1, 2] }, normalize: true }), abf.AbfSettingError, "setting"],
    [() => engine.unwrap(positions, indices, { pins: { 0: [1, 2] } }), abf.AbfSettingError, "setting"],
    [() => engine.relax(...triangle, [0, 0, 1, 0, 0, 1], { solver: "auto" }), abf.AbfSettingError, "setting"],
    [() => engine.relax(...triangle, [0, 0, 1, 0]), abf.AbfSettingError, "setting"],
    [() => engine.relax(...triangle, [0, 0, 1, 0, 0]), abf.AbfInputError, "input"],
    [() => engine.relax(...triangle, [0, 0, 1, 0, 0, NaN]), abf.AbfInputError, "not-finite"],
    [() => engine.relax(...triangle, [0, 0, 1, 0, 0, 1], { uvIndices: [0, 1, 3] }), abf.AbfInputError, "index-range"],
    [() => engine.relax(...triangle, [0, 0, 1, 0, 0, 1], { uvIndices: [0, 1] }), abf.AbfInputError, "input"],
    [() => engine.flatten(...triangle, { coverage: 0.5 }), abf.AbfSettingError, "setting"],
    [() => engine.flatten(...triangle, { errorBound: 0 }), abf.AbfSettingError, "setting"],
    [() => engine.flatten(...triangle, { errorBound: 0.5 }), abf.AbfSettingError, "setting"],
    [() => engine.unwrap(positions, indices, { coverage: 2 }), abf.AbfSettingError, "setting"],
    [() => engine.unwrap(positions, indices, { seamBudget: 1 }), abf.AbfSettingError, "setting"],
    [() => engine.unwrap(positions, indices, { innerMargin: "part" }), abf.AbfSettingError, "setting"],
    [() => engine.unwrap(positions, indices, { seams: "keep" }), abf.AbfSettingError, "setting"],
    [() => engine.unwrap(positions, indices, { seams: [0, 1, 2] }), abf.AbfInputError, "input"],
    [() => engine.unwrap(positions, indices, { seams: [0, 8] }), abf.AbfInputError, "index-range"],
    [() => engine.unwrap(positions, indices, { materials: [1] }), abf.AbfInputError, "input"],
    [() => engine.unwrap(positions, indices, { uv: [0, 1], seams: "keep" }), abf.AbfSettingError, "setting"],
    [() => engine.unwrap(positions, indices, { uv: [0, 1], uvIndices: [0], seams: "keep" }), abf.AbfInputError, "input"],
    [() => engine.flatten(positions, indices), abf.AbfMeshError, "not-a-disk"],
    [() => engine.flatten(positions, []), abf.AbfMeshError, "topology"],
    [() => engine.unwrap([0, 0, 0, 1, 0, 0, 2, 0, 0], [0, 1, 2]), abf.AbfMeshError, "geometry"],
    [() => engine.unwrap(positions, [...indices, 0, 1, 2], { strict: true }), abf.AbfMeshError, "not-clean"],
    [() => engine.unwrap(...triangle, { maxMemory: 1000 }), abf.AbfMemoryError, "memory"],
    [() => engine.unwrap(positions, indices, { texelsPerUnit: 1e5 }), abf.AbfResultError, "packing"],
  ];
  for (const [call, type, code] of cases) {
    assert.throws(call, (error) => error instanceof type && error instanceof abf.AbfError && error.code === code && error.message.length > 9, code);
  }
  assert.ok(engine.unwrap(positions, indices).injective);
});

test("what 4 GB cannot hold is refused before anything is allocated", () => {
  const before = engine.memoryBytes;
  const [positions, indices] = [new Float32Array(9e6), new Uint32Array(18e6)];
  for (const method of ["flatten", "unwrap"]) {
    assert.throws(() => engine[method](positions, indices), { code: "memory", message: /about [\d.]+ GB for 6000000 triangles/ });
  }
  assert.equal(engine.memoryBytes, before);
  assert.ok(engine.predictMemory(100_000, 50_000) > 50e6 && engine.predictMemory(100_000, 50_000) < 300e6);
});

test("progress is told, and stops and aborts are heard", () => {
  const { positions, indices } = sheet(60);
  const kinds = new Set();
  engine.flatten(positions, indices, { onProgress: (event) => void kinds.add(event.kind) });
  assert.deepEqual(["inner", "iteration", "solver", "stage", "working"].filter((kind) => !kinds.has(kind)), []);
  const stopped = engine.flatten(positions, indices, { onProgress: ({ kind }) => (kind === "iteration" ? "stop" : "continue") });
  assert.equal(stopped.termination, "cancelled");
  for (const answer of ["abort", false]) {
    assert.throws(() => engine.flatten(positions, indices, { onProgress: () => answer }), abf.AbfCancelledError);
  }
  const mine = new TypeError("mine");
  assert.throws(() => engine.unwrap(positions, indices, { onProgress: () => { throw mine; } }), (error) => error === mine);
  assert.throws(() => engine.unwrap(positions, indices, { onProgress: () => "wait" }), abf.AbfSettingError);
});

test("a time limit ends with the best so far", () => {
  const { positions, indices } = sheet(150);
  const began = performance.now();
  const flat = engine.flatten(positions, indices, { solver: "barrier", timeLimit: 0.05 });
  assert.equal(flat.termination, "time-limit");
  assert.ok(performance.now() - began < 20_000 && !flat.certified);
});

test("a hundred results take no more memory than the first", () => {
  const { positions, indices } = torus(60, 30);
  for (let i = 0; i < 3; ++i) engine.unwrap(positions, indices);
  const before = engine.memoryBytes;
  for (let i = 0; i < 100; ++i) {
    engine.flatten(sheet(12).positions, sheet(12).indices);
    engine.unwrap(positions, indices);
    assert.throws(() => engine.unwrap(positions, indices.subarray(1)));
  }
  assert.equal(engine.memoryBytes, before);
});

test("the package has the version of the library, and packs what it needs", () => {
  const manifest = JSON.parse(readFileSync(join(root, "web/package/package.json"), "utf8"));
  const [major, minor, patch] = manifest.version.split(".").map(Number);
  assert.equal(10_000 * major + 100 * minor + patch, engine.version);
  const [{ files }] = JSON.parse(execFileSync("npm", ["pack", "--dry-run", "--json"], { cwd: join(root, "web/package"), stdio: ["ignore", "pipe", "ignore"] }));
  const packed = files.map(({ path }) => path);
  const named = Object.values(manifest.exports).flatMap((entry) => (typeof entry === "string" ? [entry] : Object.values(entry)));
  for (const path of [...named, "./worker-thread.js", "./LICENSE-MIT", "./LICENSE-APACHE", "./README.md"]) {
    assert.ok(packed.includes(path.slice(2)), `${path} is not packed: ${packed}`);
  }
});

test("the library loads from bytes, from a module, and once", async () => {
  const module = await abf.compile();
  assert.equal((await abf.load(module)).version, engine.version);
  assert.equal(await abf.load(), engine);
  assert.ok(existsSync(new URL("../package/abf.wasm", import.meta.url)));
});
