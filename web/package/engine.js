// The C interface in WebAssembly, called from JavaScript. Structs are read and written by the table that the library gives.

import { AbfError, errorOf } from "./errors.js";

const KINDS = ["working", "stage", "solver", "iteration", "inner"];
const STAGES = ["topology", "solve", "layout", "certificate"];
const TERMINATIONS = ["converged", "one-pass", "max-iterations", "time-limit", "stalled", "cancelled"];
const VERDICTS = { continue: 0, stop: 1, abort: 2 };

/** 4 GB are all that 32 bits can name; some of it is the stack, the code's data and what allocation wastes. */
const ADDRESS_SPACE = 2 ** 32 - 2 ** 28;

/** Options by their names here, and the fields of AbfOptions. */
const FIELDS = {
  solver: "solver",
  layout: "layout",
  tolerance: "tolerance",
  stepTolerance: "step_tolerance",
  timeLimit: "time_limit",
  maxMemory: "max_memory",
  maxIterations: "max_iterations",
  normalize: "normalize",
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
};

const COMMON = ["solver", "layout", "tolerance", "stepTolerance", "timeLimit", "maxMemory", "maxIterations", "onProgress"];
const OF_FLATTEN = [...COMMON, "normalize"];
const OF_UNWRAP = [...new Set([...COMMON, ...Object.keys(FIELDS), "resolution", "stride"])].filter((name) => name !== "normalize");
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
    });
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
    });
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

  #run(options, allowed, call) {
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
      const fields = this.#options(options, keep);
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

  #options(options, keep) {
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
      set(field, value);
    }
    if (options.resolution !== undefined) set("width", options.resolution);
    if (options.margin === 0) set("margin", NO_MARGIN);
    if (options.timeLimit === 0) throw errorOf("setting", "timeLimit must be a number of seconds above 0, got 0");
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
      };
      for (const name of ["size", "uv64", "uv32"]) delete view[name];
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
