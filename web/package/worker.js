// The library off the page's thread. Cancelling ends the worker and starts a fresh one: no special headers are needed.

import { compile } from "./index.js";
import { errorOf } from "./errors.js";

export class AbfWorker {
  #module;
  #worker;
  #running;
  #next = 0;

  /** `source` is what `load` takes. */
  constructor(source) {
    this.#module = compile(source);
    // It is waited for when it is needed, and told then.
    this.#module.catch(() => {});
  }

  /** Whether something runs. */
  get busy() {
    return this.#running !== undefined;
  }

  /** Flattens a disk. One call at a time. */
  flatten(positions, indices, options) {
    return this.#call("flatten", positions, indices, options);
  }

  /** Relaxes UVs that anybody made. One call at a time. */
  relax(positions, indices, uv, options) {
    return this.#call("relax", positions, indices, options, uv);
  }

  /** Unwraps any mesh into an atlas. One call at a time. */
  unwrap(positions, indices, options) {
    return this.#call("unwrap", positions, indices, options);
  }

  /** Ends what runs: its promise is rejected with the code "cancelled". */
  cancel() {
    const running = this.#running;
    if (!running) return;
    this.terminate();
    running.reject(errorOf("cancelled", "cancelled before there was a result"));
  }

  /** Ends the worker. The next call starts another one. */
  terminate() {
    this.#worker?.terminate();
    this.#worker = this.#running = undefined;
  }

  async #call(method, positions, indices, options = {}, ...maps) {
    if (this.#running) throw errorOf("setting", "the worker is busy: wait for it, cancel it, or take another one");
    const { onProgress, ...rest } = options;
    const id = ++this.#next;
    return new Promise((resolve, reject) => {
      this.#running = { id, resolve, reject, onProgress };
      this.#module.then((module) => this.#post({ id, method, module, arrays: [positions, indices, ...maps], options: rest }), (error) => this.#end(id, () => reject(error)));
    });
  }

  #post(message) {
    if (this.#running?.id !== message.id) return;
    if (!this.#worker) {
      this.#worker = new Worker(new URL("./worker-thread.js", import.meta.url), { type: "module" });
      this.#worker.onmessage = ({ data }) => this.#hear(data);
      this.#worker.onerror = (event) => {
        const running = this.#running;
        this.terminate();
        running?.reject(errorOf("internal", `the worker failed: ${event.message ?? "it could not be loaded"}`));
      };
    }
    this.#worker.postMessage(message);
  }

  #hear({ id, event, result, error }) {
    const running = this.#running;
    if (running?.id !== id) return;
    if (event) running.onProgress?.(event);
    else if (error) this.#end(id, () => running.reject(errorOf(error.code, error.message)));
    else this.#end(id, () => running.resolve(result));
  }

  #end(id, settle) {
    if (this.#running?.id !== id) return;
    this.#running = undefined;
    settle();
  }
}
