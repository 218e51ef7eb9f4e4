// Meshes from files, and results to files. A mesh is { name, positions: Float64Array, indices: Uint32Array }.

/** Reads a file by its ending. */
export async function read(name, buffer) {
  const ending = name.toLowerCase().match(/\.([a-z]+)$/)?.[1];
  const readers = { obj: readObj, ply: readPly, stl: readStl, glb: readGlb };
  const reader = readers[ending];
  if (!reader) throw new Error(`${name} is not an OBJ, PLY, STL or GLB file: choose one of those`);
  let mesh;
  try {
    mesh = await reader(buffer);
  } catch (error) {
    throw new Error(`${name} cannot be read: ${error.message}`, { cause: error });
  }
  if (mesh.indices.length === 0) throw new Error(`${name} has no triangles`);
  const last = mesh.positions.length / 3;
  const wrong = mesh.indices.findIndex((index) => index >= last);
  if (wrong >= 0) throw new Error(`${name}: triangle ${Math.floor(wrong / 3)} refers to a vertex that does not exist`);
  return { name: name.replace(/\.[^.]*$/, ""), ...mesh };
}

function readObj(buffer) {
  const positions = [];
  const indices = [];
  const lines = new TextDecoder().decode(buffer).split("\n");
  lines.forEach((line, number) => {
    const words = line.trim().split(/\s+/);
    if (words[0] === "v") {
      const point = words.slice(1, 4).map(Number);
      if (point.length < 3 || point.some(Number.isNaN)) throw new Error(`line ${number + 1} is no vertex: ${line.trim()}`);
      positions.push(...point);
    } else if (words[0] === "f") {
      const corners = words.slice(1).map((word) => {
        const given = Number.parseInt(word, 10);
        const index = given < 0 ? positions.length / 3 + given : given - 1;
        if (!(index >= 0)) throw new Error(`line ${number + 1} names no vertex: ${line.trim()}`);
        return index;
      });
      for (let k = 2; k < corners.length; ++k) indices.push(corners[0], corners[k - 1], corners[k]);
    }
  });
  return { positions: Float64Array.from(positions), indices: Uint32Array.from(indices) };
}

async function readPly(buffer) {
  const { PLYLoader } = await import("three/addons/loaders/PLYLoader.js");
  return ofGeometry(new PLYLoader().parse(buffer));
}

async function readStl(buffer) {
  const { STLLoader } = await import("three/addons/loaders/STLLoader.js");
  return joined(ofGeometry(new STLLoader().parse(buffer)));
}

async function readGlb(buffer) {
  const { GLTFLoader } = await import("three/addons/loaders/GLTFLoader.js");
  const { scene } = await new GLTFLoader().parseAsync(buffer, "");
  scene.updateMatrixWorld(true);
  const parts = [];
  scene.traverse((node) => {
    if (node.isMesh) parts.push(ofGeometry(node.geometry.clone().applyMatrix4(node.matrixWorld)));
  });
  const positions = new Float64Array(parts.reduce((sum, part) => sum + part.positions.length, 0));
  const indices = new Uint32Array(parts.reduce((sum, part) => sum + part.indices.length, 0));
  let [vertex, corner] = [0, 0];
  for (const part of parts) {
    positions.set(part.positions, 3 * vertex);
    part.indices.forEach((index) => (indices[corner++] = index + vertex));
    vertex += part.positions.length / 3;
  }
  return joined({ positions, indices });
}

function ofGeometry(geometry) {
  const attribute = geometry.getAttribute("position");
  if (!attribute) throw new Error("it has no vertices");
  const positions = new Float64Array(3 * attribute.count);
  for (let v = 0; v < attribute.count; ++v) {
    positions.set([attribute.getX(v), attribute.getY(v), attribute.getZ(v)], 3 * v);
  }
  const indices = geometry.index ? Uint32Array.from(geometry.index.array) : Uint32Array.from({ length: attribute.count }, (_, v) => v);
  return { positions, indices: indices.subarray(0, indices.length - (indices.length % 3)) };
}

/** One vertex for each place: files of triangles repeat them. */
function joined({ positions, indices }) {
  const known = new Map();
  const kept = [];
  const of = new Uint32Array(positions.length / 3);
  for (let v = 0; v < of.length; ++v) {
    const point = positions.subarray(3 * v, 3 * v + 3);
    const key = point.join();
    if (!known.has(key)) {
      known.set(key, kept.length / 3);
      kept.push(...point);
    }
    of[v] = known.get(key);
  }
  return { positions: Float64Array.from(kept), indices: indices.map((index) => of[index]) };
}

/** An OBJ with the vertices of the input, and a UV per corner. */
export function writeObj({ positions, indices }, result) {
  const uv = result.uvs ?? result.uv;
  const corners = result.indices ?? indices;
  const lines = [];
  for (let v = 0; v < positions.length; v += 3) lines.push(`v ${positions[v]} ${positions[v + 1]} ${positions[v + 2]}`);
  for (let v = 0; v < uv.length; v += 2) lines.push(`vt ${uv[v]} ${uv[v + 1]}`);
  for (let c = 0; c < corners.length; c += 3) {
    const corner = (k) => `${indices[c + k] + 1}/${corners[c + k] + 1}`;
    lines.push(`f ${corner(0)} ${corner(1)} ${corner(2)}`);
  }
  return new Blob([lines.join("\n"), "\n"], { type: "text/plain" });
}

/** A GLB with one mesh: positions, UVs, triangles. glTF's v runs down. */
export function writeGlb({ positions, indices }, result) {
  const uv = result.uvs ?? result.uv;
  const corners = result.indices ?? indices;
  const count = uv.length / 2;
  const points = new Float32Array(3 * count);
  const [low, high] = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
  for (let v = 0; v < count; ++v) {
    const from = result.remap ? result.remap[v] : v;
    for (let k = 0; k < 3; ++k) {
      const x = (points[3 * v + k] = positions[3 * from + k]);
      [low[k], high[k]] = [Math.min(low[k], points[3 * v + k], x), Math.max(high[k], points[3 * v + k])];
    }
  }
  for (let k = 0; k < 3; ++k) low[k] = Math.fround(low[k]);
  const texels = Float32Array.from(uv, (x, at) => (at % 2 ? 1 - x : x));
  const parts = [points, texels, Uint32Array.from(corners)];
  let offset = 0;
  const bufferViews = parts.map((part, at) => {
    const view = { buffer: 0, byteOffset: offset, byteLength: part.byteLength, target: at === 2 ? 34963 : 34962 };
    offset += part.byteLength;
    return view;
  });
  const document = {
    asset: { version: "2.0", generator: "abf" },
    scene: 0,
    scenes: [{ nodes: [0] }],
    nodes: [{ mesh: 0 }],
    meshes: [{ primitives: [{ attributes: { POSITION: 0, TEXCOORD_0: 1 }, indices: 2 }] }],
    accessors: [
      { bufferView: 0, componentType: 5126, count, type: "VEC3", min: low, max: high },
      { bufferView: 1, componentType: 5126, count, type: "VEC2" },
      { bufferView: 2, componentType: 5125, count: corners.length, type: "SCALAR" },
    ],
    bufferViews,
    buffers: [{ byteLength: offset }],
  };
  const text = new TextEncoder().encode(JSON.stringify(document));
  const json = new Uint8Array(Math.ceil(text.length / 4) * 4).fill(0x20);
  json.set(text);
  const head = new Uint32Array([0x46546c67, 2, 12 + 8 + json.length + 8 + offset, json.length, 0x4e4f534a]);
  return new Blob([head, json, new Uint32Array([offset, 0x004e4942]), ...parts], { type: "model/gltf-binary" });
}

/** A drawing of the layout: the border of every chart, and its edges thin. */
export function writeSvg({ indices }, result) {
  const uv = result.uvs ?? result.uv;
  const corners = result.indices ?? indices;
  const { low, high } = bounds(uv);
  const size = Math.max(high[0] - low[0], high[1] - low[1]) || 1;
  const scale = 1000 / size;
  const at = (v) => `${((uv[2 * v] - low[0]) * scale).toFixed(3)} ${((high[1] - uv[2 * v + 1]) * scale).toFixed(3)}`;
  const path = (edges) => edges.map(([a, b]) => `M${at(a)}L${at(b)}`).join("");
  const { border, inner } = edges(corners, uv);
  const [width, height] = [(high[0] - low[0]) * scale, (high[1] - low[1]) * scale];
  const text = [
    `<svg xmlns="http://www.w3.org/2000/svg" viewBox="-5 -5 ${(width + 10).toFixed(3)} ${(height + 10).toFixed(3)}">`,
    `<path d="${path(inner)}" fill="none" stroke="#9ab" stroke-width="0.3"/>`,
    `<path d="${path(border)}" fill="none" stroke="#135" stroke-width="1.2"/>`,
    "</svg>",
  ];
  return new Blob([text.join("\n"), "\n"], { type: "image/svg+xml" });
}

/** The least and the greatest u and v. */
export function bounds(uv) {
  const [low, high] = [[Infinity, Infinity], [-Infinity, -Infinity]];
  for (let v = 0; v < uv.length; ++v) {
    const k = v % 2;
    if (uv[v] < low[k]) low[k] = uv[v];
    if (uv[v] > high[k]) high[k] = uv[v];
  }
  return { low, high };
}

/** The edges of a triangle list: those of one triangle, and those of two. */
export function edges(corners, uv) {
  const count = uv.length / 2;
  const seen = new Map();
  for (let c = 0; c < corners.length; ++c) {
    const a = corners[c];
    const b = corners[c % 3 === 2 ? c - 2 : c + 1];
    const key = a < b ? a * count + b : b * count + a;
    const entry = seen.get(key);
    if (entry) entry.faces += 1;
    else seen.set(key, { faces: 1, ends: [a, b], corner: c });
  }
  const [border, inner, corner] = [[], [], []];
  for (const { faces, ends, corner: at } of seen.values()) {
    if (faces === 1) {
      border.push(ends);
      corner.push(at);
    } else {
      inner.push(ends);
    }
  }
  return { border, inner, corner };
}
