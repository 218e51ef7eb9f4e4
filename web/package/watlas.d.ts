import type { Solver, Source, Unwrapped } from "./index.js";

export interface MeshDecl {
  vertexCount: number;
  vertexPositionData: Float32Array;
  /** Bytes; default 12. */
  vertexPositionStride?: number;
  indexCount?: number;
  indexData?: Uint32Array | Uint16Array | Uint8Array;
}

export interface Vertex {
  /** Texels. */
  uv: [number, number];
  /** The vertex of the input it is a copy of. */
  xref: number;
  atlasIndex: number;
  chartIndex: number;
}

export interface Mesh {
  readonly vertexCount: number;
  readonly indexCount: number;
  getVertex(index: number): Vertex;
  getIndexArray(): Uint32Array;
  getIndexArray(array: Uint32Array | Uint16Array): boolean;
}

/** Loads the library; to be called first. */
export function Initialize(source?: Source): Promise<void>;

export class Atlas {
  readonly width: number;
  readonly height: number;
  readonly meshCount: number;
  readonly atlasCount: number;
  readonly chartCount: number;
  readonly texelsPerUnit: number;
  /** What the library says of the atlas. */
  readonly report: Unwrapped | undefined;
  addMesh(mesh: MeshDecl): void;
  generate(chart?: { maxStretch?: number; solver?: Solver }, pack?: { resolution?: number; padding?: number }): void;
  getMesh(index: number): Mesh;
  delete(): void;
}
