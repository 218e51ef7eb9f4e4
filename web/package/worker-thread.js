// What runs in the worker that worker.js starts.

import { Abf } from "./engine.js";

/** Working events come thousands a second: so many milliseconds lie between two that are told. */
const QUIET = 50;

let abf;

self.onmessage = ({ data: { id, method, module, arrays, options } }) => {
  let told = 0;
  const onProgress = (event) => {
    const now = performance.now();
    if (event.kind === "working" || event.kind === "inner") {
      if (now - told < QUIET) return;
      told = now;
    }
    self.postMessage({ id, event });
  };
  try {
    abf ??= new Abf(module);
    const result = abf[method](...arrays, { ...options, onProgress });
    result.memoryBytes = abf.memoryBytes;
    const buffers = Object.values(result).filter(ArrayBuffer.isView).map((array) => array.buffer);
    self.postMessage({ id, result }, buffers);
  } catch (error) {
    self.postMessage({ id, error: { code: error.code ?? "internal", message: error.message } });
  }
};
