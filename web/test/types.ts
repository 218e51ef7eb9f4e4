// Compiled by scripts/check-web, never run: the declarations say what the package takes and gives.
import { AbfError, AbfMemoryError, load, unwrap, type Flattened } from "../package/index.js";
import { AbfWorker } from "../package/worker.js";
import { Atlas, Initialize } from "../package/watlas.js";

export async function everything(positions: Float32Array, indices: Uint16Array): Promise<number> {
  const abf = await load();
  const flat: Flattened = abf.flatten([0, 0, 0, 1, 0, 0, 0, 1, 0], [0, 1, 2], { solver: "abf++", normalize: true });
  const atlas = await unwrap(positions, indices, {
    resolution: 2048, margin: 0, weld: "0.01", holes: "fill-fan", onProgress: (event) => (event.round > 9 ? "stop" : "continue"),
  });
  abf.flatten(positions, indices, { boundary: "rectangle=0,1,2,3", solver: "linabf" });
  abf.flatten(positions, indices, { boundary: new Map([[0, Math.PI / 2]]) });
  abf.unwrap(positions, indices, { seams: [0, 1], coverage: 0.8, innerMargin: "keep", materials: indices, overlap: "allow" });
  abf.flatten(positions, indices, { energy: "usable", pins: { 0: [0, 0], 7: [1, 0, 0.5] } });
  const better: Float64Array = abf.relax(positions, indices, flat.uv, { energy: 0.5, pins: new Map([[0, [0, 0] as const]]) }).uv;
  // @ts-expect-error there is no such energy
  abf.unwrap(positions, indices, { energy: "little", maxStretch: better[0] });
  // @ts-expect-error pins are for a disk
  abf.unwrap(positions, indices, { pins: { 0: [0, 0] } });
  // @ts-expect-error a boundary is one of a disk
  abf.unwrap(positions, indices, { boundary: "circle" });
  // @ts-expect-error there is no such rule
  abf.flatten(positions, indices, { boundary: "oval" });
  // @ts-expect-error there is no such solver
  abf.flatten(positions, indices, { solver: "nothing" });
  // @ts-expect-error an atlas has a scale of its own
  abf.unwrap(positions, indices, { normalize: true });
  const worker = new AbfWorker();
  const running = worker.unwrap(positions, indices).catch((error: unknown) => {
    if (error instanceof AbfMemoryError) return error.code.length;
    if (error instanceof AbfError) return 0;
    throw error;
  });
  worker.cancel();
  await running;
  await Initialize();
  const drop = new Atlas();
  drop.addMesh({ vertexCount: positions.length / 3, vertexPositionData: positions, indexData: indices });
  drop.generate({ maxStretch: 1.1 }, { padding: 4 });
  const { uv, xref } = drop.getMesh(0).getVertex(0);
  return flat.uv[0]! + atlas.uvs[0]! + uv[0] + xref;
}
