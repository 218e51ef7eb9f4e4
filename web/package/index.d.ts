/** Numbers: positions x, y, z of vertex after vertex, or indices of triangle after triangle. */
export type Numbers = Float64Array | Float32Array | Uint32Array | Uint16Array | Uint8Array | readonly number[];

export type Solver =
  | "auto" | "linabf" | "abf" | "abf++" | "abf-newton" | "abf-fixed-target" | "uzawa" | "minres" | "barrier" | "descent"
  | "habf++" | "hlinabf" | "lscm";

/** What happened. Every field has a value; `kind` says which of them are news. */
export interface Progress {
  kind: "working" | "stage" | "solver" | "iteration" | "inner";
  stage: "topology" | "solve" | "layout" | "relax" | "certificate";
  /** The solver that begins, else null. */
  solver: string | null;
  /** Outer iterations or passes, counted from 1. */
  iteration: number;
  inner: number;
  /** Of an outer iteration max |h|, rad. */
  residual: number;
  component: number;
  components: number;
  faces: number;
  /** Faces in finished charts. */
  facesDone: number;
  round: number;
}

/** "stop" ends with the best result so far, "abort" (or false) without one. Nothing (or true) goes on. */
export type Verdict = "continue" | "stop" | "abort" | boolean | void;

/** What is to be little in a map: errors of angles, of lengths, of angles with areas within bounds, or the weight of areas. */
export type Energy = "abf" | "isometric" | "usable" | number;
/** Vertices with their places: [u, v], or [u, v, weight] where the place need not be met. */
export type Pins =
  | ReadonlyMap<number, readonly [number, number] | readonly [number, number, number]>
  | Readonly<Record<number, readonly [number, number] | readonly [number, number, number]>>;

export interface CommonOptions {
  /** Default "auto": the first of several whose result is certified. */
  solver?: Solver;
  layout?: "auto" | "least-squares" | "least-squares-weighted" | "tree" | "poisson";
  /** Largest constraint residual of a converged solve, rad; default 1e-8. */
  tolerance?: number;
  /** Largest last step of a converged solve that minimises, rad; default 1e-7. */
  stepTolerance?: number;
  /** Seconds, after which the best result so far is the result; default none. */
  timeLimit?: number;
  /** Bytes; a mesh for which more is predicted is refused. What 4 GB cannot hold is refused always. */
  maxMemory?: number;
  /** Outer iterations or passes; default 50. */
  maxIterations?: number;
  /** What becomes of faces without area; default "carry": they get a place like all others. */
  zeroArea?: "carry" | "refuse";
  /** Rings whose angle deficit is above this start from their target angles, rad; default 1; Infinity: none does. */
  ringSwitch?: number;
  /** Angles start from at least this and at most π less this, rad; default 0.001. */
  angleBound?: number;
  /** "auto" and "linabf": passes to make; default: until the constraints are met. */
  passes?: number;
  /** "linabf": no angle moves in a pass by more than this part of its way to 0 or π, in (0, 1); default: no bound. */
  errorBound?: number;
  /** "auto", "barrier" and "descent": the last weight of the barrier, in units of energy per corner; default 0.001. */
  barrierFloor?: number;
  /** Solvers with a fixed target: the wheel condition; default "product" for "abf" and "abf++", else "log". */
  wheel?: "product" | "log";
  /** Those: second derivatives; default "gauss-newton" for "abf++" and "abf-fixed-target", else "exact". */
  hessian?: "exact" | "gauss-newton";
  /** Those: whether steps are shortened until a merit function falls; default "merit". */
  lineSearch?: "merit" | "full";
  /** "uzawa" and "minres": which unknowns are eliminated first; default "triangles". */
  reduction?: "none" | "triangles";
  /** "uzawa" and "minres"; default "block". */
  preconditioner?: "none" | "jacobi" | "block";
  /** "uzawa" and "minres": inner iterations in an outer one; default 20000. */
  maxInnerIterations?: number;
  /** "uzawa" and "minres": the relative residual of inner iterations; default: it follows the constraint residual. */
  innerTolerance?: number;
  /** Relax the map, or each chart, until this energy is least; "usable" is 0.01. Not with a boundary. Default: the map stays. */
  energy?: Energy;
  /**
   * What becomes of a map that lies over itself: "off" leaves it, "split" parts it along the overlap (`indices` and `remap` are there
   * then), "deform" makes it anew without overlaps, which takes many times as long. Default "off"; charts are parted in any case.
   */
  injective?: "off" | "split" | "deform";
  /** With "deform", how far parts of the boundary stay from each other, in units of the mesh; default 0. */
  boundaryGap?: number;
  /** Hears of progress on the thread that works. What it throws comes out of the call. */
  onProgress?: (event: Progress) => Verdict;
}

export interface FlattenOptions extends CommonOptions {
  /** Scale into the unit square instead of keeping the area of the surface. */
  normalize?: boolean;
  /**
   * What the boundary is to be, with `EPS` in rad and the corners of a rectangle as vertices; or the angles of its vertices, rad.
   * "auto", "linabf" and "barrier" keep it. Default "free".
   */
  boundary?:
    | "free" | "convex" | "below-2pi" | `below-2pi=${number}` | "rectangle" | `rectangle=${string}` | "circle"
    | ReadonlyMap<number, number> | Readonly<Record<number, number>>;
  /**
   * Vertices in given places: one or two by moving, turning and scaling the map, more by moving the others with `energy`, or
   * "isometric". Not with a boundary, or `normalize`.
   */
  pins?: Pins;
}

export interface RelaxOptions {
  /** Default "isometric". */
  energy?: Energy;
  /** For one chart without seams. They say where the map is then. */
  pins?: Pins;
  /** For every index the row of its UV; default: that of its vertex. */
  uvIndices?: Numbers;
  normalize?: boolean;
  zeroArea?: "carry" | "refuse";
  timeLimit?: number;
  maxMemory?: number;
  onProgress?: (event: Progress) => Verdict;
}

export interface UnwrapOptions extends CommonOptions {
  /** Texels along the sides of a square page; default 1024. */
  resolution?: number;
  /** Texels along x; default: the resolution. */
  width?: number;
  /** Texels along y; default: the width. */
  height?: number;
  /** Texels between charts; default 2. */
  margin?: number;
  /** Pages that charts may take; default 1. */
  maxPages?: number;
  /** Texels per unit of the mesh; default: as many as fit. */
  texelsPerUnit?: number;
  /** Seams grow until the L² stretch of every chart is at most this; default 1.15. */
  maxStretch?: number;
  /** Edges that turn by at most this are smooth, rad; default π/6. */
  creaseAngle?: number;
  /** Longer charts are parted, in widths of a page; default 4; Infinity: none. */
  maxChartLength?: number;
  /** Refuse a mesh that needs repair. */
  strict?: boolean;
  /** Leave a mesh whole that is one disk. */
  keepDisks?: boolean;
  /** Which vertices are joined: a distance as text, or one of these; default "auto". */
  weld?: "auto" | "off" | `${number}`;
  holes?: "auto" | "fill" | "fill-fan" | "fill-ears" | "cut" | "free";
  /** Room for faces with the same vertices; default "own". */
  doubleSided?: "own" | "shared";
  /** How hard the packer tries; default "fast". */
  pack?: "fast" | "good" | "best";
  /** Bytes from a vertex to the next in positions; default 12. */
  stride?: number;
  /** Part the largest chart where that lets charts cover more, until they cover this part of the pages, in (0, 1]. */
  coverage?: number;
  /** By which part of their length seams may grow for that; default 0.25. */
  seamBudget?: number;
  /** Whether charts that come nearer to themselves than the margin are parted there; default "count": they are not. */
  innerMargin?: "count" | "keep";
  /** Seams grow until they are so long at most, as a multiple of the diagonal of their component. */
  maxSeam?: number;
  /** Which charts share a page; default "one". */
  atlas?: "one" | "per-component" | "per-material";
  /** Sets the margin to what mip levels up to this one need, 2 · 2^level texels. */
  mipLevels?: number;
  /** Whether a map that lies over itself is `certified`; default "refuse": it is not. */
  overlap?: "refuse" | "allow";
  /**
   * Where charts end. "auto": where the map stretches. "keep": at the seams of `uv`, and where `materials` change. An array: there,
   * and at these edges, two vertices each. Default "auto", and "keep" for pages per material.
   */
  seams?: "auto" | "keep" | Numbers;
  /** UVs that the mesh has: u and v of vertex after vertex, or of row after row with `uvIndices`. */
  uv?: Numbers;
  /** For every index the row of its UV. */
  uvIndices?: Numbers;
  /** A number for every triangle. */
  materials?: Numbers;
  /** A number for every triangle: vertices in one place are joined within one object only. */
  objects?: Numbers;
  /** A number for every triangle: no seam runs between two of one polygon. */
  polygons?: Numbers;
}

/** What is proved and measured of a map. */
export interface Quality {
  vertexCount: number;
  triangleCount: number;
  chartCount: number;
  /**
   * Valid, and every solver ended as asked. Of an atlas: every chart is finished, and nothing lies over anything else, unless
   * `overlap` allows that.
   */
  certified: boolean;
  /** No triangle is flipped or collapsed, no interior vertex wound around twice. Proved with exact signs. */
  valid: boolean;
  /** Valid, and nothing lies over anything else. */
  injective: boolean;
  termination: "converged" | "one-pass" | "max-iterations" | "time-limit" | "stalled" | "cancelled";
  flips: number;
  collapsed: number;
  wound: number;
  overlaps: number;
  /** F / 3nt, rad². */
  angleError: number;
  /** 1 for an isometry. */
  stretchL2: number;
  stretchLinf: number;
  /** 1 for a conformal map. */
  qcMean: number;
  qcMax: number;
  /** 0 where areas keep their proportions. */
  areaL2: number;
  surfaceArea: number;
  uvArea: number;
  /** Whose result it is; "several" where charts differ; empty of `relax`. */
  solver: string;
  /** How many steps `energy` took, all charts together. */
  relaxSteps: number;
  /** The energy before and at the end, for a surface of area 1; of several charts the mean by area. 0 without steps. */
  energyBefore: number;
  energyAfter: number;
  /** How many pins must be met and are not, of those that were tried. */
  pinsMissed: number;
  /** How far each pinned vertex is from its place, in the order of `pins`. */
  pinDistances?: Float64Array;
}

export interface Flattened extends Quality {
  /** u and v of every vertex of the input; or of every row, where the map was parted. */
  uv: Float64Array;
  /** Where the map was parted: the row of every index, and the vertex of every row. */
  indices?: Uint32Array;
  remap?: Uint32Array;
}

export interface Relaxed extends Quality {
  /** u and v of every vertex of the input; or of every row, with `uvIndices`. */
  uv: Float64Array;
  /** With `uvIndices`: the row of every index, and the vertex of every row. */
  indices?: Uint32Array;
  remap?: Uint32Array;
  /** The chart of every triangle. */
  triangleCharts: Uint32Array;
}

export interface Unwrapped extends Quality {
  /** u and v of every new vertex, in the unit square of its page. */
  uvs: Float32Array;
  /** Three new vertices per triangle, in the order of the input. */
  indices: Uint32Array;
  /** For every new vertex the vertex of the input it is a copy of. */
  remap: Uint32Array;
  /** The chart of every triangle; 0xffffffff where it is in none. */
  triangleCharts: Uint32Array;
  /** The page of every chart. */
  chartPages: Uint32Array;
  pageCount: number;
  /** Texels of a page. */
  width: number;
  height: number;
  texelsPerUnit: number;
  /** The part of the pages that charts cover. */
  coverage: number;
  /** Charts that there was no time to finish. */
  unfinished: number;
  /** What was repaired; empty where nothing was. */
  repairs: string;
  /** Cuts that were made for `coverage`. */
  partedForCoverage: number;
  /** Cuts that were made for `innerMargin`. */
  partedForMargin: number;
}

/** The library, loaded. Calls return when they are done: in a page, take `abf-flatten/worker`. */
export class Abf {
  constructor(module: WebAssembly.Module);
  readonly memoryBytes: number;
  readonly version: number;
  flatten(positions: Numbers, indices: Numbers, options?: FlattenOptions): Flattened;
  /** A chart that cannot be relaxed, as it is no manifold for example, stays as it was. The result is not certified then. */
  relax(positions: Numbers, indices: Numbers, uv: Numbers, options?: RelaxOptions): Relaxed;
  unwrap(positions: Numbers, indices: Numbers, options?: UnwrapOptions): Unwrapped;
  /** About how many bytes it takes at most to flatten a disk. */
  predictMemory(triangles: number, vertexCount: number, solver?: Solver): number;
}

export type Source = string | URL | Response | ArrayBuffer | ArrayBufferView | WebAssembly.Module;

/** Loads the library: by default abf.wasm beside the package's files, once. */
export function load(source?: Source): Promise<Abf>;
/** Compiles the library, to be sent to workers. */
export function compile(source?: Source): Promise<WebAssembly.Module>;
/** Flattens a disk: one UV per vertex. */
export function flatten(positions: Numbers, indices: Numbers, options?: FlattenOptions): Promise<Flattened>;
/** Relaxes UVs that anybody made until an energy is least, each chart by itself; charts may come to lie over each other. */
export function relax(positions: Numbers, indices: Numbers, uv: Numbers, options?: RelaxOptions): Promise<Relaxed>;
/** Unwraps any mesh into an atlas. */
export function unwrap(positions: Numbers, indices: Numbers, options?: UnwrapOptions): Promise<Unwrapped>;

export type Code =
  | "pointer" | "struct-size" | "too-large" | "stride" | "index-count" | "index-range" | "not-finite" | "setting"
  | "not-a-disk" | "topology" | "geometry" | "not-clean" | "memory" | "cancelled" | "no-result" | "packing" | "threads"
  | "internal" | "input";

/** Every failure of the library. */
export class AbfError extends Error {
  constructor(code: Code, message: string);
  readonly code: Code;
}
export class AbfInputError extends AbfError {}
export class AbfSettingError extends AbfError {}
export class AbfMeshError extends AbfError {}
export class AbfMemoryError extends AbfError {}
export class AbfCancelledError extends AbfError {}
export class AbfResultError extends AbfError {}
export class AbfInternalError extends AbfError {}
export const CODES: readonly Code[];
/** An error of the class that its code has. */
export function errorOf(code: Code, message: string): AbfError;
