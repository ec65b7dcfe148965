// Reads NRRD and NIfTI-1 files of one scalar volume into samples and a geometry in LPS.

/** `format` as DecompressionStream names it. */
export async function inflated(bytes, format) {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream(format));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}
const unzipped = (bytes) => (bytes[0] === 0x1f && bytes[1] === 0x8b ? inflated(bytes, "gzip") : bytes);

/** Samples of a type that the core has: others become float32. */
export function samplesOf(bytes, type, big, count) {
  const kinds = {
    uint8: ["getUint8", 1, Uint8Array], int8: ["getInt8", 1, Int16Array], int16: ["getInt16", 2, Int16Array],
    uint16: ["getUint16", 2, Uint16Array], int32: ["getInt32", 4, Float32Array], uint32: ["getUint32", 4, Float32Array],
    float32: ["getFloat32", 4, Float32Array], float64: ["getFloat64", 8, Float32Array],
  };
  if (!kinds[type]) throw new Error(`samples of type ${type} are not read`);
  const [read, size, Type] = kinds[type];
  if (bytes.byteLength < count * size) throw new Error("the file ends before its samples do");
  if (!big && Type.name.toLowerCase() === `${type}array`) return new Type(bytes.slice(0, count * size).buffer);
  const view = new DataView(bytes.buffer, bytes.byteOffset);
  return Type.from({ length: count }, (_, i) => view[read](i * size, !big));
}

const unitsOfLength = new Map([["m", 1000], ["cm", 10], ["mm", 1], ["um", 0.001], ["", 1]]); // [mm]
export function millimetresIn(unit) {
  if (!unitsOfLength.has(unit)) throw new Error(`the unit of length '${unit}' is not read`);
  return unitsOfLength.get(unit);
}

const length = (v) => Math.hypot(...v);
/** Geometry from the columns that lead from a sample to the next along each axis. */
export function geometryOf(size, axes, origin) {
  const spacing = axes.map((axis) => length(axis) || 1);
  const direction = [0, 1, 2].flatMap((row) => axes.map((axis, a) => axis[row] / spacing[a]));
  return { size, spacing, origin, direction };
}

async function readNrrd(bytes) {
  let end = 0;
  while (end < bytes.length && !(bytes[end] === 10 && (bytes[end + 1] === 10 || (bytes[end + 1] === 13 && bytes[end + 2] === 10)))) ++end;
  const fields = {};
  for (const line of new TextDecoder().decode(bytes.subarray(0, end)).split(/\r?\n/)) {
    const [, name, value] = /^([^#:]+):=? ?(.*)$/.exec(line) ?? [];
    if (name) fields[name.trim().toLowerCase()] = value.trim();
  }
  if (fields["data file"] || fields.datafile) throw new Error("the samples of this NRRD are in another file");
  for (const name of ["line skip", "lineskip", "byte skip", "byteskip"]) {
    if (Number(fields[name] ?? 0) !== 0) throw new Error(`NRRD files with a ${name} of ${fields[name]} are not read`);
  }
  const size = (fields.sizes ?? "").split(/\s+/).map(Number);
  if (size.length !== 3) throw new Error("only NRRD files of three dimensions are read");
  const rest = bytes.subarray(end + (bytes[end + 1] === 13 ? 3 : 2));
  if (!["raw", "gzip", "gz"].includes(fields.encoding)) throw new Error(`the encoding ${fields.encoding} is not read`);
  const types = {
    "unsigned char": "uint8", uchar: "uint8", uint8_t: "uint8", "signed char": "int8", short: "int16", "signed short": "int16",
    "short int": "int16", int16_t: "int16", "unsigned short": "uint16", ushort: "uint16", uint16_t: "uint16", int: "int32", float: "float32",
    double: "float64",
  };
  const vectors = [...(fields["space directions"] ?? "").matchAll(/\(([^)]*)\)/g)].map((m) => m[1].split(",").map(Number));
  const spacings = (fields.spacings ?? "1 1 1").split(/\s+/).map(Number);
  const axes = vectors.length === 3 ? vectors : spacings.map((s, a) => [0, 1, 2].map((b) => (a === b ? s : 0)));
  const origin = /\(([^)]*)\)/.exec(fields["space origin"] ?? "")?.[1].split(",").map(Number) ?? [0, 0, 0];
  const space = (fields.space ?? "").toLowerCase();
  const flips = { "right-anterior-superior": [-1, -1, 1], ras: [-1, -1, 1], "left-anterior-superior": [1, -1, 1], las: [1, -1, 1] }[space] ?? [1, 1, 1];
  const units = space ? [...(fields["space units"] ?? "").matchAll(/"([^"]*)"/g)].map((m) => millimetresIn(m[1])) : [];
  const lps = (v) => v.map((x, a) => x * flips[a] * (units[a] ?? 1));
  const samples = samplesOf(await unzipped(rest), types[fields.type] ?? fields.type, fields.endian === "big", size[0] * size[1] * size[2]);
  return { samples, geometry: geometryOf(size, axes.map(lps), lps(origin)) };
}

function readNifti(bytes) {
  const view = new DataView(bytes.buffer, bytes.byteOffset);
  const little = view.getInt32(0, true) === 348;
  const short = (at) => view.getInt16(at, little);
  const real = (at) => view.getFloat32(at, little);
  const sizes = [0, 1, 2, 3, 4, 5, 6].map((axis) => (axis < short(40) ? short(42 + 2 * axis) : 1));
  if (sizes.slice(3).some((n) => n > 1)) throw new Error(`only NIfTI files of three dimensions are read, this one has ${short(40)}`);
  const size = sizes.slice(0, 3);
  const types = { 2: "uint8", 4: "int16", 8: "int32", 16: "float32", 64: "float64", 256: "int8", 512: "uint16", 768: "uint32" };
  const offset = Math.max(348, real(108));
  let samples = samplesOf(bytes.subarray(offset), types[short(70)] ?? short(70), !little, size[0] * size[1] * size[2]);
  const [slope, intercept] = [real(112), real(116)];
  if (slope !== 0 && Number.isFinite(slope)) { // else none is given
    if (!Number.isFinite(intercept)) throw new Error(`the intercept ${intercept} of this NIfTI is not a number`);
    if (slope !== 1 || intercept !== 0) samples = Float32Array.from(samples, (v) => slope * v + intercept);
  }
  let axes = [80, 84, 88].map((at, a) => [0, 1, 2].map((b) => (a === b ? real(at) : 0)));
  let origin = [0, 0, 0];
  if (short(254) > 0) {
    const rows = [280, 296, 312].map((row) => [0, 4, 8, 12].map((at) => real(row + at)));
    axes = [0, 1, 2].map((a) => rows.map((row) => row[a]));
    origin = rows.map((row) => row[3]);
  } else if (short(252) > 0) {
    const [b, c, d] = [256, 260, 264].map(real);
    const a = Math.sqrt(Math.max(0, 1 - b * b - c * c - d * d));
    const turn = [
      [a * a + b * b - c * c - d * d, 2 * (b * c - a * d), 2 * (b * d + a * c)],
      [2 * (b * c + a * d), a * a + c * c - b * b - d * d, 2 * (c * d - a * b)],
      [2 * (b * d - a * c), 2 * (c * d + a * b), a * a + d * d - b * b - c * c],
    ];
    const steps = [real(80), real(84), real(88) * (real(76) < 0 ? -1 : 1)];
    axes = [0, 1, 2].map((column) => turn.map((row) => row[column] * steps[column]));
    origin = [268, 272, 276].map(real);
  }
  const unit = millimetresIn(["", "m", "mm", "um"][view.getUint8(123) & 7] ?? `number ${view.getUint8(123) & 7}`);
  const flip = short(254) > 0 || short(252) > 0 ? -1 : 1; // NIfTI has RAS; without a place, axes are taken as they are
  const lps = ([x, y, z]) => [flip * unit * x, flip * unit * y, unit * z];
  return { samples, geometry: geometryOf(size, axes.map(lps), lps(origin)) };
}

export function isDicom(bytes) {
  return new TextDecoder().decode(bytes.subarray(128, 132)) === "DICM";
}

/** Throws an Error that says what is wrong. */
export async function readVolume(buffer) {
  const bytes = await unzipped(new Uint8Array(buffer));
  if (new TextDecoder().decode(bytes.subarray(0, 4)) === "NRRD") return readNrrd(bytes);
  if (new TextDecoder().decode(bytes.subarray(344, 346)) === "n+") return readNifti(bytes);
  throw new Error("this is neither NRRD nor NIfTI-1 in one file");
}
