// Every failure is an AbfError with a code. Classes group the codes that a program treats alike.

export class AbfError extends Error {
  constructor(code, message) {
    super(message);
    this.name = new.target.name;
    this.code = code;
  }
}

/** The arrays cannot be a mesh: a count, an index, a coordinate. */
export class AbfInputError extends AbfError {}
/** A setting out of range, or a name that nothing has. */
export class AbfSettingError extends AbfError {}
/** The mesh is not what was asked for: no disk, no manifold, no area, in need of repair. */
export class AbfMeshError extends AbfError {}
/** It would take more memory than there is, or than was allowed. */
export class AbfMemoryError extends AbfError {}
/** The run was cancelled. */
export class AbfCancelledError extends AbfError {}
/** There is no map, or the charts do not fit. */
export class AbfResultError extends AbfError {}
/** A defect of the library. */
export class AbfInternalError extends AbfError {}

const CLASSES = {
  pointer: AbfInternalError,
  "struct-size": AbfInternalError,
  "too-large": AbfMemoryError,
  stride: AbfInputError,
  "index-count": AbfInputError,
  "index-range": AbfInputError,
  "not-finite": AbfInputError,
  setting: AbfSettingError,
  "not-a-disk": AbfMeshError,
  topology: AbfMeshError,
  geometry: AbfMeshError,
  "not-clean": AbfMeshError,
  memory: AbfMemoryError,
  cancelled: AbfCancelledError,
  "no-result": AbfResultError,
  packing: AbfResultError,
  threads: AbfInternalError,
  internal: AbfInternalError,
  input: AbfInputError,
};

/** The codes there are. */
export const CODES = Object.keys(CLASSES);

/** An error of the class that its code has. */
export function errorOf(code, message) {
  return new (CLASSES[code] ?? AbfInternalError)(code, message);
}
