// The library under the interface of watlas: what glTF-Transform's `unwrap({ watlas })` calls.

import { load } from "./index.js";
import { errorOf } from "./errors.js";

let abf;

/** Loads the library; `source` is what `load` takes. */
export async function Initialize(source) {
  abf ??= await load(source);
}

export class Atlas {
  #meshes = [];
  #out = [];
  #result;

  /** Adds a mesh. All meshes share one atlas. */
  addMesh(mesh) {
    const { vertexCount, vertexPositionData, vertexPositionStride = 12, indexData } = mesh;
    if (!vertexPositionData) throw errorOf("input", "a mesh needs vertexPositionData");
    const step = vertexPositionStride / 4;
    const positions = new Float32Array(3 * vertexCount);
    for (let v = 0; v < vertexCount; ++v) {
      for (let k = 0; k < 3; ++k) positions[3 * v + k] = vertexPositionData[step * v + k];
    }
    const indices = indexData ? Uint32Array.from(indexData) : Uint32Array.from({ length: vertexCount }, (_, v) => v);
    this.#meshes.push({ positions, indices });
  }

  /** Unwraps all meshes. Of the chart options there are maxStretch and solver, of the pack options resolution and padding. */
  generate(chartOptions = {}, packOptions = {}) {
    if (!abf) throw errorOf("setting", "call Initialize first");
    const firsts = [];
    let [vertices, corners] = [0, 0];
    for (const { positions, indices } of this.#meshes) {
      firsts.push(vertices);
      vertices += positions.length / 3;
      corners += indices.length;
    }
    const positions = new Float32Array(3 * vertices);
    const indices = new Uint32Array(corners);
    let at = 0;
    this.#meshes.forEach((mesh, m) => {
      positions.set(mesh.positions, 3 * firsts[m]);
      for (const index of mesh.indices) indices[at++] = index + firsts[m];
    });
    const options = { resolution: packOptions.resolution || 1024, margin: packOptions.padding || 2 };
    if (chartOptions.maxStretch) options.maxStretch = chartOptions.maxStretch;
    if (chartOptions.solver) options.solver = chartOptions.solver;
    this.#result = abf.unwrap(positions, indices, options);
    this.#out = this.#split(firsts);
  }

  /** The meshes with vertices of their own, in texels. */
  #split(firsts) {
    const { indices, remap, uvs, triangleCharts, chartPages } = this.#result;
    const sides = [this.width, this.height];
    let corner = 0;
    return this.#meshes.map((mesh, m) => {
      const seen = new Map();
      const vertices = [];
      const own = new Uint32Array(mesh.indices.length);
      for (let k = 0; k < own.length; ++k, ++corner) {
        const vertex = indices[corner];
        if (!seen.has(vertex)) {
          const chart = triangleCharts[Math.floor(corner / 3)];
          const inChart = chart !== 0xffffffff;
          seen.set(vertex, vertices.length);
          vertices.push({
            uv: [uvs[2 * vertex] * sides[0], uvs[2 * vertex + 1] * sides[1]],
            xref: remap[vertex] - firsts[m],
            atlasIndex: inChart ? chartPages[chart] : -1,
            chartIndex: inChart ? chart : -1,
          });
        }
        own[k] = seen.get(vertex);
      }
      return new Mesh(vertices, own);
    });
  }

  getMesh(index) {
    const mesh = this.#out[index];
    if (!mesh) throw errorOf("input", `there is no mesh ${index}: ${this.#out.length} were unwrapped`);
    return mesh;
  }

  /** What the library says of the atlas: certificate, distortion, coverage. */
  get report() {
    return this.#result;
  }

  get meshCount() {
    return this.#out.length;
  }

  get width() {
    return this.#result?.width ?? 0;
  }

  get height() {
    return this.#result?.height ?? 0;
  }

  get atlasCount() {
    return this.#result?.pageCount ?? 0;
  }

  get chartCount() {
    return this.#result?.chartCount ?? 0;
  }

  get texelsPerUnit() {
    return this.#result?.texelsPerUnit ?? 0;
  }

  delete() {
    this.#meshes = [];
    this.#out = [];
    this.#result = undefined;
  }
}

class Mesh {
  #vertices;
  #indices;

  constructor(vertices, indices) {
    this.#vertices = vertices;
    this.#indices = indices;
  }

  get vertexCount() {
    return this.#vertices.length;
  }

  get indexCount() {
    return this.#indices.length;
  }

  getVertex(index) {
    return this.#vertices[index];
  }

  getIndexArray(array) {
    if (!array) return this.#indices.slice();
    array.set(this.#indices);
    return true;
  }
}
