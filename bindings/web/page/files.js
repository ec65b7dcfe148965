// What the readers of DICOM and Zarr have in common: refusals, samples of all types, grids.

/** Throws an Error that says what is wrong and what to do. */
export function refuse(what, advice = "convert it first, for example with `palpate convert IN OUT.nrrd`") {
  throw new Error(`${what}: ${advice}`);
}

/** The number of samples, if it is sensible. */
export function countOf(size) {
  if (!size.every((n) => Number.isInteger(n) && n > 0)) refuse(`a grid of ${size.join(" x ")} samples is not possible`);
  const count = size.reduce((all, n) => all * n, 1);
  if (count > 2 ** 27) refuse(`there are ${(count / 2 ** 20).toFixed(0)} million samples, too many for a page`, "save a part, or a coarser one");
  return count;
}

/** Samples that are no number become the least one, as in the native program. */
export function finite(samples, notes) {
  if (!(samples instanceof Float32Array)) return samples;
  const least = samples.reduce((low, v) => (Number.isFinite(v) && v < low ? v : low), Infinity);
  if (samples.every(Number.isFinite)) return samples;
  notes.push("samples that are no number became the least one");
  return samples.map((v) => (Number.isFinite(v) ? v : Number.isFinite(least) ? least : 0));
}

/** A number of 16 bits (IEEE 754-2008): of a sign, five bits of an exponent, and ten of a fraction. */
function half(bits) {
  const [exponent, fraction] = [(bits >> 10) & 31, bits & 1023];
  const size = exponent === 0 ? fraction * 2 ** -24 : exponent < 31 ? (1024 + fraction) * 2 ** (exponent - 25) : fraction ? NaN : Infinity;
  return bits >> 15 ? -size : size;
}

/** Samples of a type that the core has: others become float32. */
export function samplesOf(bytes, type, big, count) {
  const kinds = {
    uint8: ["getUint8", 1, Uint8Array], int8: ["getInt8", 1, Int16Array], int16: ["getInt16", 2, Int16Array],
    uint16: ["getUint16", 2, Uint16Array], int32: ["getInt32", 4, Float32Array], uint32: ["getUint32", 4, Float32Array],
    int64: ["getBigInt64", 8, Float32Array], uint64: ["getBigUint64", 8, Float32Array],
    float16: ["getUint16", 2, Float32Array], float32: ["getFloat32", 4, Float32Array], float64: ["getFloat64", 8, Float32Array],
  };
  if (!kinds[type]) refuse(`samples of type ${type} are not read`);
  const [read, size, Type] = kinds[type];
  if (bytes.byteLength < count * size) refuse("the file ends before its samples do", "copy or download it again");
  if (!big && Type.name.toLowerCase() === `${type}array`) return new Type(bytes.slice(0, count * size).buffer);
  const view = new DataView(bytes.buffer, bytes.byteOffset);
  const number = type === "float16" ? half : Number;
  return Type.from({ length: count }, (_, i) => number(view[read](i * size, !big)));
}

/** Geometry from the columns that lead from a sample to the next along each axis. */
export function geometryOf(size, axes, origin) {
  const spacing = axes.map((axis) => Math.hypot(...axis));
  if (!spacing.every((s) => s >= 1e-9 && s <= 1e9)) refuse(`a spacing of ${spacing.join(" x ")} mm is not possible`);
  if (!origin.every((x) => Math.abs(x) <= 1e9)) refuse(`an origin of ${origin.join(", ")} mm is not possible`);
  const direction = [0, 1, 2].flatMap((row) => axes.map((axis, a) => axis[row] / spacing[a] + 0)); // no -0
  for (const [a, b] of [[0, 1], [0, 2], [1, 2]]) {
    const along = [0, 3, 6].reduce((sum, row) => sum + direction[row + a] * direction[row + b], 0);
    if (!(Math.abs(along) < 1e-4)) refuse("its axes are not at right angles (sheared)");
  }
  return { size, spacing, origin, direction };
}

export function isDicom(bytes) {
  return new TextDecoder().decode(bytes.subarray(128, 132)) === "DICM";
}
