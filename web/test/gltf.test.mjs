// glTF-Transform's own unwrap with the package in place of watlas, on real GLBs: the Khronos validator finds nothing new, and every
// mesh has UVs of its own. Charts and stretch stand beside those of watlas.
import assert from "node:assert/strict";
import { existsSync, readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join } from "node:path";
import test from "node:test";
import { pathToFileURL } from "node:url";
import * as ours from "../package/watlas.js";
import { torus } from "./shapes.mjs";

const require = createRequire(join(process.env.ABF_PACKAGES, "package.json"));
const take = (name) => import(pathToFileURL(require.resolve(name)).href);
const { Document, NodeIO } = await take("@gltf-transform/core");
const { ALL_EXTENSIONS } = await take("@gltf-transform/extensions");
const { unwrap } = await take("@gltf-transform/functions");
const watlas = await take("watlas");
const validator = require("gltf-validator");

const io = new NodeIO().registerExtensions(ALL_EXTENSIONS);
const files = ["knight.glb", "truck.glb", "helmet.glb", "shapecol.glb", "alphablend.glb"];
await ours.Initialize();
await watlas.Initialize();

function made() {
  const document = new Document();
  const buffer = document.createBuffer();
  const { positions, indices } = torus(40, 20);
  const scene = document.createScene();
  for (const shift of [0, 7]) {
    const moved = positions.map((x, at) => (at % 3 === 0 ? x + shift : x));
    const primitive = document.createPrimitive()
      .setAttribute("POSITION", document.createAccessor().setType("VEC3").setArray(moved).setBuffer(buffer))
      .setIndices(document.createAccessor().setType("SCALAR").setArray(indices).setBuffer(buffer));
    scene.addChild(document.createNode().setMesh(document.createMesh().addPrimitive(primitive)));
  }
  return document;
}

async function faults(bytes) {
  const report = await validator.validateBytes(bytes, { maxIssues: 0 });
  return report.issues.messages.filter(({ severity }) => severity === 0).map(({ code, pointer, message }) => `${code} ${pointer} ${message}`);
}

/** L² stretch of a document's UVs over all its triangles, at one scale (Sander et al. 2001); a page has so many texels. */
function stretch(document, page) {
  let [weighted, surface, flat] = [0, 0, 0];
  for (const mesh of document.getRoot().listMeshes()) {
    for (const primitive of mesh.listPrimitives()) {
      const [p, t] = ["POSITION", "TEXCOORD_0"].map((name) => primitive.getAttribute(name));
      const indices = primitive.getIndices()?.getArray();
      for (let f = 0; f < (indices?.length ?? p.getCount()); f += 3) {
        const corner = [0, 1, 2].map((k) => (indices ? indices[f + k] : f + k));
        const [a, b, c] = corner.map((v) => p.getElement(v, []));
        const [u, v, w] = corner.map((v) => t.getElement(v, []));
        const side = (x, y) => x.map((value, k) => value - y[k]);
        const [e, g] = [side(b, a), side(c, a)];
        const length = Math.hypot(...e);
        const along = (e[0] * g[0] + e[1] * g[1] + e[2] * g[2]) / length;
        const up = Math.sqrt(Math.max(Math.hypot(...g) ** 2 - along ** 2, 0));
        if (!(length > 0 && up > 0)) continue;
        const i = side(v, u).map((x, k) => (x * page[k]) / length);
        const j = side(w, u).map((x, k) => (x * page[k] - i[k] * along) / up);
        const grown = Math.abs(i[0] * j[1] - i[1] * j[0]);
        const area = (length * up) / 2;
        weighted += ((i[0] ** 2 + i[1] ** 2 + j[0] ** 2 + j[1] ** 2) / (2 * grown ** 2)) * area;
        surface += area;
        flat += grown * area;
      }
    }
  }
  return Math.sqrt(weighted / surface) * Math.sqrt(flat / surface);
}

async function both(name, read) {
  const line = [name.padEnd(16)];
  for (const [label, library] of [["abf", ours], ["watlas", watlas]]) {
    const document = await read();
    let charts = 0;
    let page = [1, 1];
    // The atlas of each library, with its charts counted when it is done.
    class Counted {
      constructor() {
        const atlas = new library.Atlas();
        const generate = atlas.generate.bind(atlas);
        atlas.generate = (...options) => {
          generate(...options);
          charts += atlas.chartCount;
          page = [atlas.width, atlas.height];
        };
        return atlas;
      }
    }
    const counted = { Initialize: library.Initialize, Atlas: Counted };
    const before = document.getRoot().listMeshes().flatMap((mesh) => mesh.listPrimitives().map((p) => (p.getIndices() ?? p.getAttribute("POSITION")).getCount()));
    const old = await faults(await io.writeBinary(document));
    const began = process.cpuUsage();
    await document.transform(unwrap({ watlas: counted, texcoord: 0, overwrite: true, groupBy: "scene" }));
    const { user, system } = process.cpuUsage(began);
    const bytes = await io.writeBinary(document);
    const vertices = document.getRoot().listMeshes().flatMap((mesh) => mesh.listPrimitives()).reduce((sum, p) => sum + p.getAttribute("POSITION").getCount(), 0);
    const l2 = stretch(document, page);
    line.push(`${label}: ${charts} charts, ${vertices} vertices, L2 ${l2.toFixed(3)}, ${((user + system) / 1e6).toFixed(2)} s CPU`);
    if (label !== "abf") continue;
    assert.deepEqual((await faults(bytes)).filter((fault) => !old.includes(fault)), [], name);
    const after = document.getRoot().listMeshes().flatMap((mesh) => mesh.listPrimitives().map((p) => p.getIndices().getCount()));
    assert.deepEqual(after, before);
    for (const primitive of document.getRoot().listMeshes().flatMap((mesh) => mesh.listPrimitives())) {
      const uv = primitive.getAttribute("TEXCOORD_0").getArray();
      assert.ok(uv.every((x) => x >= 0 && x <= 1), `${name}: UVs outside of the texture`);
    }
    assert.ok(l2 < 1.2, `${name}: L2 ${l2}`);
  }
  console.log(line.join("   "));
}

test("two meshes of a scene share an atlas", () => both("two tori", async () => made()));

for (const name of files) {
  const file = join(process.env.ABF_ASSETS ?? "", name);
  const skip = process.env.ABF_ASSETS && existsSync(file) ? false : "it is not in $ABF_ASSETS";
  test(name, { skip }, () => both(name, () => io.readBinary(new Uint8Array(readFileSync(file)))));
}

test("what watlas answers is answered", () => {
  const { positions, indices } = torus(20, 10);
  const atlas = new ours.Atlas();
  atlas.addMesh({ vertexCount: positions.length / 3, vertexPositionData: positions, vertexPositionStride: 12, indexData: indices });
  atlas.generate({}, { resolution: 256, padding: 3 });
  const mesh = atlas.getMesh(0);
  const array = new Uint32Array(mesh.indexCount);
  assert.ok(mesh.getIndexArray(array));
  assert.deepEqual(Uint32Array.from(array, (vertex) => mesh.getVertex(vertex).xref), indices);
  assert.deepEqual([atlas.width, atlas.height, atlas.meshCount, atlas.atlasCount], [256, 256, 1, 1]);
  assert.ok(atlas.report.injective && atlas.chartCount === atlas.report.chartCount && atlas.texelsPerUnit > 0);
  assert.throws(() => atlas.getMesh(1), { code: "input" });
  atlas.delete();
});
