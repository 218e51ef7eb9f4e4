// The C interface in WebAssembly, called from JavaScript. Structs are read and written by the table that the library gives.

import { AbfError, errorOf } from "./errors.js";

const KINDS = ["working", "stage", "solver", "iteration", "inner"];
const STAGES = ["topology", "solve", "layout", "certificate", "relax"];
const TERMINATIONS = ["converged", "one-pass", "max-iterations", "time-limit", "stalled", "cancelled"];
const VERDICTS = { continue: 0, stop: 1, abort: 2 };

/** 4 GB are all that 32 bits can name; some of it is the stack, the code's data and what allocation wastes. */
const ADDRESS_SPACE = 2 ** 32 - 2 ** 28;

/** Options of both calls by their names here, and the fields of AbfOptions. */
const COMMON = {
  solver: "solver",
  layout: "layout",
  zeroArea: "zero_area",
  tolerance: "tolerance",
  stepTolerance: "step_tolerance",
  timeLimit: "time_limit",
  maxMemory: "max_memory",
  maxIterations: "max_iterations",
  ringSwitch: "ring_switch",
  angleBound: "angle_bound",
  passes: "passes",
  errorBound: "error_bound",
  barrierFloor: "barrier_floor",
  wheel: "wheel",
  hessian: "hessian",
  lineSearch: "line_search",
  reduction: "reduction",
  preconditioner: "preconditioner",
  maxInnerIterations: "max_inner_iterations",
  innerTolerance: "inner_tolerance",
  energy: "energy",
  injective: "injective",
  boundaryGap: "boundary_gap",
};
/** Those of `unwrap` alone. */
const CHARTS = {
  strict: "strict",
  keepDisks: "keep_disks",
  margin: "margin",
  width: "width",
  height: "height",
  maxPages: "max_pages",
  maxStretch: "max_stretch",
  creaseAngle: "crease_angle",
  maxChartLength: "max_chart_length",
  texelsPerUnit: "texels_per_unit",
  weld: "weld",
  holes: "holes",
  doubleSided: "double_sided",
  pack: "pack",
  coverage: "coverage",
  seamBudget: "seam_budget",
  innerMargin: "inner_margin",
  maxSeam: "max_seam",
  atlas: "atlas",
  mipLevels: "mip_levels",
  overlap: "overlap",
};
const FIELDS = { ...COMMON, ...CHARTS, normalize: "normalize" };
/** Arrays with a number for every triangle. */
const LABELS = ["materials", "objects", "polygons"];

const OF_FLATTEN = [...Object.keys(COMMON), "onProgress", "normalize", "boundary", "pins"];
const OF_RELAX = ["energy", "pins", "timeLimit", "maxMemory", "zeroArea", "normalize", "onProgress"];
const OF_UNWRAP = [...Object.keys(COMMON), "onProgress", ...Object.keys(CHARTS), "resolution", "stride", "seams", "uv", "uvIndices", ...LABELS];
/** Where 0 would be taken for the default, and is none. */
const NOT_ZERO = [
  "timeLimit", "passes", "errorBound", "barrierFloor", "ringSwitch", "angleBound", "maxInnerIterations", "innerTolerance", "coverage",
  "seamBudget", "maxSeam",
];
/** What margin is for none. */
const NO_MARGIN = 0xffffffff;

export class Abf {
  #module;
  #exports;
  #layout;
  #calls = [];

  constructor(module) {
    this.#module = module;
    this.#start();
  }

  /** Bytes that the instance holds. They never shrink, but are used again. */
  get memoryBytes() {
    return this.#exports.memory.buffer.byteLength;
  }

  /** The version: 10000 major + 100 minor + patch. */
  get version() {
    return this.#exports.abf_version();
  }

  /** Flattens a disk: one UV per vertex. */
  flatten(positions, indices, options = {}) {
    const input = numbers(positions, Float64Array, "positions");
    return this.#run(options, OF_FLATTEN, (fields, result, keep) => {
      const count = vertices(input.length, 3);
      this.#check(count, indices.length / 3, options.solver, 1);
      return this.#exports.abf_flatten(keep(input), count, keep(whole(indices)), indices.length, fields, result);
    }, indices.length);
  }

  /** Relaxes UVs that anybody made, each chart by itself: one per vertex, or those of `uvIndices`. */
  relax(positions, indices, uv, { uvIndices, ...options } = {}) {
    const input = numbers(positions, Float64Array, "positions");
    const map = times(numbers(uv, Float64Array, "uv"), 2, "uv", "row");
    return this.#run(options, OF_RELAX, (fields, result, keep) => {
      const count = vertices(input.length, 3);
      this.#check(count, indices.length / 3, "descent", 1);
      const corners = uvIndices == null ? 0 : keep(long(whole(uvIndices), indices.length, "uvIndices", "index"));
      const mesh = [keep(input), count, keep(whole(indices)), indices.length];
      return this.#exports.abf_relax(...mesh, keep(map), map.length / 2, corners, fields, result);
    }, indices.length);
  }

  /** Unwraps any mesh into an atlas. */
  unwrap(positions, indices, options = {}) {
    const input = numbers(positions, Float32Array, "positions");
    return this.#run(options, OF_UNWRAP, (fields, result, keep) => {
      const stride = options.stride ?? 12;
      const step = stride / 4;
      const last = input.length % step;
      const count = stride === 12 ? vertices(input.length, 3) : Math.floor(input.length / step) + (last >= 3 ? 1 : 0);
      // The flattening of the largest chart is the smaller part.
      this.#check(count, indices.length / 3, undefined, 2);
      return this.#exports.abf_unwrap(keep(input), count, stride, keep(whole(indices)), indices.length, fields, result);
    }, indices.length);
  }

  /** About how many bytes it takes at most to flatten a disk. */
  predictMemory(triangles, vertexCount, solver) {
    const name = solver === undefined ? null : this.#put(text(solver));
    const bytes = this.#exports.abf_predict_memory(name?.at ?? 0, triangles, vertexCount);
    if (name) this.#free(name);
    if (bytes === 0n) throw errorOf("setting", this.#text(this.#exports.abf_last_error()));
    return Number(BigInt.asUintN(64, bytes));
  }

  #start() {
    const imports = {
      clock: () => performance.now(),
      progress: (_, event) => this.#tell(event),
    };
    this.#exports = new WebAssembly.Instance(this.#module, { abf: imports }).exports;
    this.#exports.abf_web_start();
    this.#layout ??= JSON.parse(this.#text(this.#exports.abf_web_layout()));
  }

  /** Refuses what 4 GB cannot hold before anything is allocated. */
  #check(vertexCount, corners, solver, times) {
    const triangles = Math.ceil(corners);
    const lean = solver === undefined || solver === "auto" ? "linabf" : solver;
    const predicted = times * this.predictMemory(triangles, vertexCount, lean) + 24 * vertexCount + 12 * triangles;
    if (predicted <= ADDRESS_SPACE) return;
    const gigabytes = (predicted / 1e9).toFixed(1);
    const text = `it would take about ${gigabytes} GB for ${triangles} triangles, and WebAssembly has 4 GB`;
    throw errorOf("memory", `${text}; use the program or the library outside of a browser`);
  }

  #run(options, allowed, call, corners) {
    const unknown = Object.keys(options).find((name) => !allowed.includes(name));
    if (unknown) throw errorOf("setting", `there is no option '${unknown}'; there are: ${allowed.join(", ")}`);
    const kept = [];
    const keep = (array) => {
      const block = this.#put(array);
      kept.push(block);
      return block.at;
    };
    const state = { tell: options.onProgress, thrown: undefined };
    this.#calls.push(state);
    try {
      const fields = this.#options(options, keep, corners);
      const result = keep(new Uint8Array(4));
      const status = call(fields, result, keep);
      if (state.thrown) throw state.thrown.error;
      if (status !== 0) throw errorOf(this.#layout.statuses[status], this.#text(this.#exports.abf_last_error()));
      return this.#result(new DataView(this.#exports.memory.buffer).getUint32(result, true), keep);
    } catch (error) {
      if (error instanceof WebAssembly.RuntimeError) throw this.#broken(error, kept);
      throw error;
    } finally {
      this.#calls.pop();
      kept.forEach((block) => this.#free(block));
    }
  }

  /** After a trap nothing in the instance can be relied upon: there is a new one for the next call. */
  #broken(error, kept) {
    let said = "";
    try {
      said = this.#text(this.#exports.abf_last_error());
    } catch {
      // What it said is lost with it.
    }
    const full = this.memoryBytes > ADDRESS_SPACE - 2 ** 28;
    kept.length = 0;
    this.#start();
    if (full) return errorOf("memory", "the 4 GB of WebAssembly are used up: take fewer triangles");
    const broken = errorOf("internal", `${said || error.message}: please report it with the mesh`);
    broken.cause = error;
    return broken;
  }

  #options(options, keep, corners) {
    const { size, fields } = this.#layout.AbfOptions;
    const view = new DataView(new ArrayBuffer(size));
    const set = (field, value) => {
      const [at, type] = fields[field];
      if (type === "f64") view.setFloat64(at, number(field, value), true);
      else if (type === "u64") view.setBigUint64(at, BigInt(Math.floor(number(field, value))), true);
      else if (type === "text") view.setUint32(at, keep(text(value)), true);
      else view.setUint32(at, natural(field, value), true);
    };
    set("size", size);
    for (const [name, field] of Object.entries(FIELDS)) {
      const value = options[name];
      if (value === undefined || value === null) continue;
      if (value === 0 && NOT_ZERO.includes(name)) throw errorOf("setting", `${name} must not be 0: leave it out for the default`);
      set(field, value);
    }
    for (const [field, value] of arrays(options, corners)) {
      set(field, ArrayBuffer.isView(value) ? keep(value) : value);
    }
    if (options.resolution !== undefined) set("width", options.resolution);
    if (options.margin === 0) set("margin", NO_MARGIN);
    if (options.onProgress) set("progress", this.#exports.abf_web_progress());
    return keep(new Uint8Array(view.buffer));
  }

  #tell(at) {
    const call = this.#calls.at(-1);
    if (!call?.tell) return VERDICTS.continue;
    const event = this.#read("AbfEvent", at);
    event.kind = KINDS[event.kind];
    event.stage = STAGES[event.stage];
    try {
      const said = call.tell(event) ?? "continue";
      if (said === true) return VERDICTS.continue;
      if (said === false) return VERDICTS.abort;
      if (said in VERDICTS) return VERDICTS[said];
      throw errorOf("setting", `onProgress may return "continue", "stop" or "abort", not ${String(said)}`);
    } catch (error) {
      call.thrown = { error };
      return VERDICTS.abort;
    }
  }

  #result(at, keep) {
    try {
      const { size } = this.#layout.AbfView;
      const block = new Uint8Array(size);
      new DataView(block.buffer).setUint32(0, size, true);
      const place = keep(block);
      this.#exports.abf_result_view(at, place);
      const view = this.#read("AbfView", place);
      const take = (type, from, count) => (from === 0 ? undefined : new type(this.#exports.memory.buffer, from, count).slice());
      const n = view.vertexCount;
      const arrays = {
        uv: take(Float64Array, view.uv64, 2 * n),
        uvs: take(Float32Array, view.uv32, 2 * n),
        remap: take(Uint32Array, view.remap, n),
        indices: take(Uint32Array, view.indices, 3 * view.triangleCount),
        triangleCharts: take(Uint32Array, view.triangleCharts, view.triangleCount),
        chartPages: take(Uint32Array, view.chartPages, view.chartCount),
        pinDistances: take(Float64Array, view.pinDistances, view.pinCount),
      };
      for (const name of ["size", "uv64", "uv32", "pinCount"]) delete view[name];
      view.termination = TERMINATIONS[view.termination];
      for (const [name, array] of Object.entries(arrays)) {
        if (array) view[name] = array;
        else delete view[name];
      }
      return view;
    } finally {
      this.#exports.abf_result_free(at);
    }
  }

  /** A struct as an object, with names as they are usual here. */
  #read(struct, at) {
    const memory = new DataView(this.#exports.memory.buffer, at);
    const fields = Object.entries(this.#layout[struct].fields).map(([name, [place, type]]) => {
      const camel = name.replace(/_([a-z0-9])/g, (_, letter) => letter.toUpperCase());
      if (type === "f64") return [camel, memory.getFloat64(place, true)];
      if (type === "bool") return [camel, memory.getUint8(place) !== 0];
      const value = memory.getUint32(place, true);
      return [camel, type !== "text" ? value : value === 0 ? null : this.#text(value)];
    });
    return Object.fromEntries(fields);
  }

  #put(array) {
    const bytes = array.byteLength;
    const at = this.#exports.abf_web_alloc(bytes);
    if (at === 0) throw errorOf("memory", `there is no room for ${bytes} bytes of arguments: take fewer triangles`);
    new Uint8Array(this.#exports.memory.buffer, at, bytes).set(new Uint8Array(array.buffer, array.byteOffset, bytes));
    return { at, bytes };
  }

  #free({ at, bytes }) {
    this.#exports.abf_web_free(at, bytes);
  }

  #text(at) {
    const memory = new Uint8Array(this.#exports.memory.buffer);
    return new TextDecoder().decode(memory.slice(at, memory.indexOf(0, at)));
  }
}

function text(value) {
  return new TextEncoder().encode(`${value}\0`);
}

function number(name, value) {
  if (typeof value !== "number") throw errorOf("setting", `${name} must be a number, got ${String(value)}`);
  return value;
}

function natural(name, value) {
  const given = typeof value === "boolean" ? Number(value) : value;
  if (!Number.isInteger(given) || given < 0 || given > 0xffffffff) {
    throw errorOf("setting", `${name} must be a whole number of at least 0, got ${String(value)}`);
  }
  return given;
}

function numbers(given, Type, name) {
  if (given instanceof Type) return given;
  const is = Array.isArray(given) || (ArrayBuffer.isView(given) && !(given instanceof DataView));
  if (!is) throw errorOf("input", `${name} must be an array of numbers`);
  return Type.from(given, Number);
}

function vertices(length, per) {
  if (length % per !== 0) throw errorOf("input", `positions has ${length} numbers, which is not ${per} per vertex`);
  return length / per;
}

/** Options that are arrays, or names instead: the fields of AbfOptions with what goes there. */
function arrays(options, corners) {
  const { boundary, seams, uv, uvIndices, pins } = options;
  const fields = [];
  const add = (field, array, count) => fields.push([field, array], ...(count ? [[count[0], array.length / count[1]]] : []));
  if (typeof boundary === "string") fields.push(["boundary", boundary]);
  else if (boundary != null) {
    const given = boundary instanceof Map ? [...boundary] : Object.entries(boundary);
    add("boundary_vertices", whole(given.map(([vertex]) => Number(vertex))), ["boundary_count", 1]);
    add("boundary_angles", numbers(given.map(([, angle]) => angle), Float64Array, "boundary"));
  }
  if (pins != null) {
    const given = pins instanceof Map ? [...pins] : Object.entries(pins);
    const wrong = given.find(([, place]) => !(Array.isArray(place) || ArrayBuffer.isView(place)) || ![2, 3].includes(place.length));
    if (wrong) throw errorOf("input", `the pin of vertex ${wrong[0]} must be [u, v] or [u, v, weight]`);
    const soft = given.find(([, place]) => place.length === 3 && !(place[2] > 0));
    if (soft) throw errorOf("setting", `the weight of the pin of vertex ${soft[0]} must be positive, got ${soft[1][2]}`);
    add("pin_vertices", whole(given.map(([vertex]) => Number(vertex))), ["pin_count", 1]);
    add("pin_uvs", numbers(given.flatMap(([, [u, v]]) => [u, v]), Float64Array, "pins"));
    add("pin_weights", numbers(given.map(([, place]) => place[2] ?? 0), Float64Array, "pins"));
  }
  if (typeof seams === "string") fields.push(["seams", seams]);
  else if (seams != null) add("seam_vertices", times(whole(seams), 2, "seams", "edge"), ["seam_count", 2]);
  if (uv != null) add("uv", times(numbers(uv, Float32Array, "uv"), 2, "uv", "row"), ["uv_count", 2]);
  if (uvIndices != null) add("uv_indices", long(whole(uvIndices), corners, "uvIndices", "index"));
  for (const name of LABELS) {
    if (options[name] != null) add(name, long(whole(options[name]), Math.floor(corners / 3), name, "triangle"));
  }
  return fields;
}

function times(array, per, name, what) {
  if (array.length % per === 0) return array;
  throw errorOf("input", `${name} has ${array.length} numbers, which is not ${per} per ${what}`);
}

function long(array, length, name, what) {
  if (array.length === length) return array;
  throw errorOf("input", `${name} must have a number for each ${what}, ${length} in all, got ${array.length}`);
}

/** Indices in 32 bits; what is no index is refused rather than rounded. */
function whole(indices) {
  if (indices instanceof Uint32Array) return indices;
  if (indices instanceof Uint16Array || indices instanceof Uint8Array) return Uint32Array.from(indices);
  const list = numbers(indices, Float64Array, "indices");
  const wrong = list.findIndex((index) => !Number.isInteger(index) || index < 0 || index > 0xffffffff);
  if (wrong >= 0) throw errorOf("index-range", `index ${wrong} is ${list[wrong]}, which is no vertex`);
  return Uint32Array.from(list);
}

export { AbfError };
