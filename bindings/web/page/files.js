// Reads NRRD and NIfTI-1 files of one scalar volume into samples and a geometry in LPS. What is not known to be read as
// the native program reads it is refused.

/** Throws an Error that says what is wrong and what to do. */
export function refuse(what, advice = "convert it first, for example with `palpate convert IN OUT.nrrd`") {
  throw new Error(`${what}: ${advice}`);
}

/** `format` as DecompressionStream names it; more than `most` bytes are refused. */
export async function inflated(bytes, format, most = 2 ** 30) {
  const reader = new Blob([bytes]).stream().pipeThrough(new DecompressionStream(format)).getReader();
  const parts = [];
  for (let size = 0; ;) {
    const { done, value } = await reader.read();
    if (done) return new Uint8Array(await new Blob(parts).arrayBuffer());
    parts.push(value);
    size += value.length;
    if (size > most) {
      reader.cancel().catch(() => {});
      refuse(`data unpack to more than the ${most} bytes that were expected`, "the file is damaged, or too large for a page");
    }
  }
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

/** Samples of a type that the core has: others become float32. */
export function samplesOf(bytes, type, big, count) {
  const kinds = {
    uint8: ["getUint8", 1, Uint8Array], int8: ["getInt8", 1, Int16Array], int16: ["getInt16", 2, Int16Array],
    uint16: ["getUint16", 2, Uint16Array], int32: ["getInt32", 4, Float32Array], uint32: ["getUint32", 4, Float32Array],
    float32: ["getFloat32", 4, Float32Array], float64: ["getFloat64", 8, Float32Array],
  };
  if (!kinds[type]) refuse(`samples of type ${type} are not read`);
  const [read, size, Type] = kinds[type];
  if (bytes.byteLength < count * size) refuse("the file ends before its samples do", "copy or download it again");
  if (!big && Type.name.toLowerCase() === `${type}array`) return new Type(bytes.slice(0, count * size).buffer);
  const view = new DataView(bytes.buffer, bytes.byteOffset);
  return Type.from({ length: count }, (_, i) => view[read](i * size, !big));
}

/** The same of a file. As much again or more is no padding: the type is wider than its header says. */
function samplesOfFile(bytes, type, big, count) {
  const needed = (count * Number(type.match(/\d+$/)?.[0])) / 8;
  if (bytes.byteLength >= 2 * needed) refuse(`its header asks for ${needed} bytes of samples, there are ${bytes.byteLength}`, "correct the sizes or the type in its header");
  return samplesOf(bytes, type, big, count);
}

const unitsOfLength = new Map([["m", 1000], ["cm", 10], ["mm", 1], ["um", 0.001], ["", 1]]); // [mm]
export function millimetresIn(unit) {
  if (!unitsOfLength.has(unit)) refuse(`the unit of length '${unit}' is not read`);
  return unitsOfLength.get(unit);
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

const typesOfNrrd = new Map(Object.entries({
  int8: "signed char,int8,int8_t", uint8: "uchar,unsigned char,uint8,uint8_t", float32: "float", float64: "double",
  int16: "short,short int,signed short,signed short int,int16,int16_t", uint16: "ushort,unsigned short,unsigned short int,uint16,uint16_t",
  int32: "int,signed int,int32,int32_t", uint32: "uint,unsigned int,uint32,uint32_t",
}).flatMap(([type, names]) => names.split(",").map((name) => [name, type])));
const spaces = { // factors to LPS
  "3d-right-handed": [1, 1, 1], // of no body, as the native program writes it
  "left-posterior-superior": [1, 1, 1], lps: [1, 1, 1], "right-anterior-superior": [-1, -1, 1], ras: [-1, -1, 1],
  "left-anterior-superior": [1, -1, 1], las: [1, -1, 1],
};

/** The fields of the header, without blanks in their names, and where the samples begin. */
function fieldsOf(bytes) {
  let end = 0;
  while (end < bytes.length && !(bytes[end] === 10 && (bytes[end + 1] === 10 || (bytes[end + 1] === 13 && bytes[end + 2] === 10)))) ++end;
  if (end === bytes.length) refuse("this NRRD ends within its header", "copy or download it again");
  const [fields, spelled] = [{}, {}];
  for (const line of new TextDecoder().decode(bytes.subarray(0, end)).split(/\r?\n/)) {
    const [, name, value] = /^([^#:]+):(?!=)(.*)$/.exec(line) ?? [];
    const key = name?.toLowerCase().replaceAll(" ", "");
    if (key in fields) refuse(`this NRRD has the field '${name}' twice`);
    if (name) [fields[key], spelled[key]] = [value.trim(), name];
  }
  return { fields, spelled, begin: end + (bytes[end + 1] === 13 ? 3 : 2) };
}

const numbersIn = (text, name, count = 3) => {
  const list = text.trim().split(/[\s,]+/).map((word) => (word === "" ? NaN : Number(word)));
  if (list.length !== count || !list.every(Number.isFinite)) refuse(`the field '${name}' of this file has '${text}' in place of ${count} numbers`);
  return list;
};
const quotedIn = (text = "") => [...text.matchAll(/"([^"]*)"/g)].map((m) => m[1]);

/** Where the grid lies: by a space and directions, or by spacings. */
function placeOfNrrd(fields, size, notes) {
  const name = (fields.space ?? "").toLowerCase();
  if (name !== "" && !spaces[name]) refuse(`the space '${fields.space}' of this NRRD is not read`);
  if ((fields.spacedimension ?? "3") !== "3") refuse("NRRD of a space that has not three dimensions is not read");
  for (const field of ["axismins", "axismaxs"]) if (fields[field]) refuse(`the field '${field}' of this NRRD is not read`);
  if (name === "" && !fields.spacedimension) {
    for (const field of ["spacedirections", "spaceorigin"]) if (fields[field]) refuse(`this NRRD has the field '${field}' and no space`);
    if (quotedIn(fields.units).some((unit) => unit !== "" && unit !== "mm")) refuse(`the units ${fields.units} of this NRRD are not read`);
    if (!fields.spacings) notes.push("it gives no spacing: 1 mm was taken");
    const spacings = numbersIn(fields.spacings ?? "1 1 1", "spacings");
    if (!spacings.every((s) => s > 0)) refuse(`the spacings ${fields.spacings} of this NRRD are not read`);
    return { geometry: geometryOf(size, spacings.map((s, a) => [0, 1, 2].map((b) => (a === b ? s : 0))), [0, 0, 0]), oriented: false };
  }
  if (fields.spacings) refuse("this NRRD has both spacings and a space");
  const vectors = /^\(([^()]*)\)\s*\(([^()]*)\)\s*\(([^()]*)\)$/.exec(fields.spacedirections ?? "")?.slice(1);
  if (!vectors) refuse(`the space directions '${fields.spacedirections ?? ""}' of this NRRD are not three vectors`);
  const origin = /^\(([^()]*)\)$/.exec(fields.spaceorigin ?? "(0,0,0)")?.[1] ?? "";
  const units = quotedIn(fields.spaceunits);
  if (fields.spaceunits && units.length !== 3) refuse(`the space units ${fields.spaceunits} of this NRRD are not three`);
  const factors = (spaces[name] ?? [1, 1, 1]).map((sign, a) => sign * millimetresIn(units[a] ?? ""));
  const lps = (text, field) => numbersIn(text, field).map((x, a) => x * factors[a]);
  return { geometry: geometryOf(size, vectors.map((v) => lps(v, "space directions")), lps(origin, "space origin")), oriented: !["", "3d-right-handed"].includes(name) };
}

async function readNrrd(bytes) {
  const { fields, spelled, begin } = fieldsOf(bytes);
  const notes = [];
  if (fields.datafile !== undefined) refuse("the samples of this NRRD are in another file");
  for (const skip of ["lineskip", "byteskip"]) {
    if (Number(fields[skip] ?? 0) !== 0) refuse(`NRRD files with a ${spelled[skip]} of ${fields[skip]} are not read`);
  }
  const size = (fields.sizes ?? "").split(/\s+/).map(Number);
  if (size.length !== 3 || fields.dimension !== "3") refuse("only NRRD files of three dimensions are read");
  const count = countOf(size);
  for (const kind of (fields.kinds ?? "").toLowerCase().split(/\s+/)) {
    if (!["", "domain", "space", "???", "none"].includes(kind)) refuse(`NRRD with an axis of kind '${kind}' is not read`);
  }
  const type = typesOfNrrd.get((fields.type ?? "").toLowerCase());
  const endian = (fields.endian ?? "").toLowerCase();
  if (!type) refuse(`samples of type ${fields.type} are not read`);
  if (!type.endsWith("8") && endian !== "little" && endian !== "big") refuse(`this NRRD has the endian '${endian}'`, "correct its header, it is little or big");
  const encoding = (fields.encoding ?? "").toLowerCase();
  if (!["raw", "gzip", "gz"].includes(encoding)) refuse(`the encoding ${fields.encoding} is not read`);
  const place = placeOfNrrd(fields, size, notes);
  const rest = bytes.subarray(begin);
  const data = encoding === "raw" ? rest : await inflated(rest, "gzip", 8 * count + 2 ** 20);
  return { samples: finite(samplesOfFile(data, type, endian === "big", count), notes), ...place, notes };
}

function readNifti(bytes) {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const notes = [];
  const little = view.getInt32(0, true) === 348;
  if (!little && view.getInt32(0) !== 348) refuse("this NIfTI does not begin with the size of its header");
  const short = (at) => view.getInt16(at, little);
  const real = (at) => view.getFloat32(at, little);
  if (short(40) < 1 || short(40) > 7) refuse(`a NIfTI file of ${short(40)} dimensions is not possible`);
  const sizes = [0, 1, 2, 3, 4, 5, 6].map((axis) => (axis < short(40) ? short(42 + 2 * axis) : 1));
  if (sizes.slice(3).some((n) => n !== 1)) refuse(`only NIfTI files of three dimensions are read, this one has ${short(40)}`);
  const size = sizes.slice(0, 3);
  const types = { 2: "uint8", 4: "int16", 8: "int32", 16: "float32", 64: "float64", 256: "int8", 512: "uint16", 768: "uint32" };
  const type = types[short(70)] ?? refuse(`samples of type ${short(70)} are not read`);
  if (short(72) !== 0 && !type.endsWith(String(short(72)))) refuse("the bits of a sample of this NIfTI do not fit their type");
  const offset = real(108);
  if (!(offset >= 348 && offset < 1e9 && Number.isInteger(offset))) refuse(`the header of this NIfTI puts the samples at byte ${offset} (vox_offset)`);
  let samples = samplesOfFile(bytes.subarray(offset), type, !little, countOf(size));
  const [slope, intercept] = [real(112), real(116)];
  if (slope !== 0 && Number.isFinite(slope)) { // else none is given
    if (!Number.isFinite(intercept)) refuse(`the intercept ${intercept} of this NIfTI is not a number`);
    if (slope !== 1 || intercept !== 0) samples = Float32Array.from(samples, (v) => slope * v + intercept);
  }
  const hasSform = short(254) > 0;
  const placed = hasSform || short(252) > 0;
  const steps = [80, 84, 88].map(real);
  if (!hasSform && !steps.every((s) => s > 0)) refuse(`the spacing ${steps.join(" x ")} of this NIfTI (pixdim) is not possible`);
  let axes = steps.map((step, a) => [0, 1, 2].map((b) => (a === b ? step : 0)));
  let origin = [0, 0, 0];
  if (hasSform) {
    const rows = [280, 296, 312].map((row) => [0, 4, 8, 12].map((at) => real(row + at)));
    axes = [0, 1, 2].map((a) => rows.map((row) => row[a]));
    origin = rows.map((row) => row[3]);
  } else if (placed) {
    const vector = [256, 260, 264].map(real);
    const square = vector.reduce((sum, x) => sum + x * x, 0);
    if (!(square <= 1.002)) refuse("the quaternion of this NIfTI is no rotation");
    const whole = [Math.sqrt(Math.max(0, 1 - square)), ...vector];
    const [a, b, c, d] = whole.map((x) => x / Math.hypot(...whole));
    const turn = [
      [a * a + b * b - c * c - d * d, 2 * (b * c - a * d), 2 * (b * d + a * c)],
      [2 * (b * c + a * d), a * a + c * c - b * b - d * d, 2 * (c * d - a * b)],
      [2 * (b * d - a * c), 2 * (c * d + a * b), a * a + d * d - b * b - c * c],
    ];
    steps[2] *= real(76) < 0 ? -1 : 1;
    axes = [0, 1, 2].map((column) => turn.map((row) => row[column] * steps[column]));
    origin = [268, 272, 276].map(real);
  } else {
    notes.push("it does not say how it lies in the body: its axes were taken as those of LPS");
  }
  const code = view.getUint8(123) & 7;
  if (code === 0) notes.push("it names no unit of length: mm were taken");
  const unit = millimetresIn(["", "m", "mm", "um"][code] ?? `number ${code}`);
  const flip = placed ? -1 : 1; // NIfTI has RAS
  const lps = ([x, y, z]) => [flip * unit * x, flip * unit * y, unit * z];
  return { samples: finite(samples, notes), geometry: geometryOf(size, axes.map(lps), lps(origin)), oriented: placed, notes };
}

export function isDicom(bytes) {
  return new TextDecoder().decode(bytes.subarray(128, 132)) === "DICM";
}

/** Samples, geometry, whether it is that of a body, and notes on what was assumed. */
export async function readVolume(given) {
  const raw = new Uint8Array(given); // bytes or a buffer
  const bytes = raw[0] === 0x1f && raw[1] === 0x8b ? await inflated(raw, "gzip") : raw;
  const text = (from, to) => new TextDecoder().decode(bytes.subarray(from, to));
  if (/^NRRD000[1-5]$/.test(text(0, 8))) return readNrrd(bytes);
  if (text(344, 348) === "n+1\0") return readNifti(bytes);
  return refuse("this is neither NRRD nor NIfTI-1 in one file");
}
