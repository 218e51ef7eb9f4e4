// UV unwrapping in browsers and Node. `load` once, or let `flatten` and `unwrap` do so.

import { Abf } from "./engine.js";

export * from "./errors.js";
export { Abf };

let loaded;

/**
 * Loads the library. Without an argument from abf.wasm beside this file; else from an address, a response, bytes or a module.
 * A second call without an argument gives the same instance.
 */
export async function load(source) {
  if (source === undefined) return (loaded ??= load(new URL("./abf.wasm", import.meta.url)));
  return new Abf(await compile(source));
}

/** Compiles the library, to be sent to workers. */
export async function compile(source = new URL("./abf.wasm", import.meta.url)) {
  if (source instanceof WebAssembly.Module) return source;
  if (source instanceof ArrayBuffer || ArrayBuffer.isView(source)) return WebAssembly.compile(source);
  if (typeof Response !== "undefined" && source instanceof Response) return WebAssembly.compile(await source.arrayBuffer());
  const url = new URL(source, import.meta.url);
  if (url.protocol === "file:" && typeof process !== "undefined" && process.versions?.node) {
    const { readFile } = await import("node:fs/promises");
    return WebAssembly.compile(await readFile(url));
  }
  const response = await fetch(url);
  if (!response.ok) throw new Error(`${url} cannot be loaded: ${response.status} ${response.statusText}`);
  return WebAssembly.compile(await response.arrayBuffer());
}

/** Flattens a disk: one UV per vertex. */
export async function flatten(positions, indices, options) {
  return (await load()).flatten(positions, indices, options);
}

/** Relaxes UVs that anybody made, each chart by itself. */
export async function relax(positions, indices, uv, options) {
  return (await load()).relax(positions, indices, uv, options);
}

/** Unwraps any mesh into an atlas. */
export async function unwrap(positions, indices, options) {
  return (await load()).unwrap(positions, indices, options);
}
