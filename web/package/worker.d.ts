import type { FlattenOptions, Flattened, Numbers, RelaxOptions, Relaxed, Source, UnwrapOptions, Unwrapped } from "./index.js";

/** The library in a worker, which cancelling ends; the next call starts another one. */
export class AbfWorker {
  constructor(source?: Source);
  readonly busy: boolean;
  /** Progress is told, but its answer is not waited for: `cancel` ends a run. */
  flatten(positions: Numbers, indices: Numbers, options?: FlattenOptions): Promise<Flattened & { memoryBytes: number }>;
  relax(positions: Numbers, indices: Numbers, uv: Numbers, options?: RelaxOptions): Promise<Relaxed & { memoryBytes: number }>;
  unwrap(positions: Numbers, indices: Numbers, options?: UnwrapOptions): Promise<Unwrapped & { memoryBytes: number }>;
  /** Ends what runs: its promise is rejected with the code "cancelled". */
  cancel(): void;
  terminate(): void;
}
