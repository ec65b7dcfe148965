// Reads a level of an OME-Zarr (0.4 to 0.6), or a Zarr array, into samples and a geometry. `get(path, isMetadata)` gives
// the bytes of an object below the root, or null: from dropped files, or from a server. What is not known to be read as
// the native program reads it is refused.
import { codecNamed, crc32c } from "./codecs.js";
import { countOf, finite, geometryOf, refuse, samplesOf } from "./files.js";

const mostSamples = 2 ** 25; // finer levels are left out
const millimetres = { "": 1, angstrom: 1e-7, foot: 304.8, inch: 25.4, mile: 1609344, yard: 914.4 };
const prefixes = { atto: -18, femto: -15, pico: -12, nano: -9, micro: -6, milli: -3, centi: -2, deci: -1, "": 0, deca: 1, hecto: 2, kilo: 3 };
for (const [prefix, power] of Object.entries(prefixes)) millimetres[`${prefix}meter`] = Number(`1e${power + 3}`);
const typesOfZarr2 = {
  u1: "uint8", i1: "int8", u2: "uint16", i2: "int16", u4: "uint32", i4: "int32", u8: "uint64", i8: "int64", f2: "float16", f4: "float32", f8: "float64",
};
const widths = { uint8: 1, int8: 1, uint16: 2, int16: 2, uint32: 4, int32: 4, uint64: 8, int64: 8, float16: 2, float32: 4, float64: 8 };

async function json(get, path) {
  const bytes = await get(path, true);
  try {
    return bytes && JSON.parse(new TextDecoder().decode(bytes));
  } catch {
    return refuse(`${path} of this Zarr is no JSON`, "copy or download it again");
  }
}

const membersOfZarr3 = [
  "zarr_format", "node_type", "shape", "data_type", "chunk_grid", "fill_value", "codecs", "attributes", "chunk_key_encoding",
  "storage_transformers", "dimension_names", "consolidated_metadata",
];
/** Others have to be understood if they do not say otherwise. */
function checkMembers(whole) {
  const unknown = Object.keys(whole).find((name) => !membersOfZarr3.includes(name) && whole[name]?.must_understand !== false);
  if (unknown !== undefined) refuse(`the member '${unknown}' of this Zarr is not known, and has to be understood`);
}

/** Metadata of a group or an array: Zarr 3, else Zarr 2. */
async function node(get, path) {
  const whole = await json(get, `${path}zarr.json`);
  if (whole) checkMembers(whole);
  if (whole) return { array: whole.node_type === "array" ? described3(whole) : null, attributes: whole.attributes ?? {} };
  const [array, attributes] = await Promise.all([json(get, `${path}.zarray`), json(get, `${path}.zattrs`)]);
  return { array: array && described2(array), attributes: attributes ?? {} };
}

/** The value of samples that are not stored. */
function fillOf(fill, type) {
  if (fill === undefined || fill === null) return 0;
  const isReal = type.startsWith("float");
  if (isReal && ["NaN", "Infinity", "-Infinity"].includes(fill)) return NaN;
  const bits = 8 * widths[type];
  const [least, most] = type[0] === "u" ? [0, 2 ** bits - 1] : [-(2 ** (bits - 1)), 2 ** (bits - 1) - 1];
  const fits = typeof fill === "number" && (isReal || (Number.isInteger(fill) && fill >= least && fill <= most));
  return fits ? fill : refuse(`the fill_value ${JSON.stringify(fill)} of this Zarr is not read`);
}

function checked(array) {
  const { shape, chunks, separator } = array;
  if (separator !== "." && separator !== "/") refuse(`the separator '${separator}' of the chunks of this Zarr is not read`);
  const isSize = (n) => Number.isInteger(n) && n > 0;
  if (!Array.isArray(shape) || !shape.every(isSize)) refuse("the shape of this Zarr array is not possible");
  if (chunks?.length !== shape.length || !chunks.every(isSize)) refuse("the chunks of this Zarr array have no possible size");
  if (array.codecs[0]?.name !== "sharding_indexed") countOf(chunks);
  return array;
}

function described2({ zarr_format: format, shape, chunks, dtype, compressor, filters, fill_value: fill, order, dimension_separator: separator = "." }) {
  const type = typeof dtype === "string" && dtype.length === 3 && typesOfZarr2[dtype.slice(1)];
  if (format !== 2 || !type || !"<>|".includes(dtype[0]) || (dtype[0] === "|" && widths[type] > 1)) refuse(`Zarr arrays of type ${JSON.stringify(dtype)} are not read in the browser`);
  if (filters?.length > 0) refuse(`the filter ${filters[0].id} of this Zarr is not read in the browser`);
  if (order !== "C" && order !== "F") refuse(`the order '${order}' of this Zarr is not read`);
  const codecs = [{ name: "bytes", configuration: { endian: dtype[0] === ">" ? "big" : "little" } }];
  if (order === "F") codecs.unshift({ name: "transpose", configuration: { order: shape.map((_, i) => shape.length - 1 - i) } });
  if (compressor) codecs.push({ name: compressor.id });
  return checked({ shape, chunks, type, codecs, fill: fillOf(fill, type), separator, key: (at) => at.join(separator) });
}

function described3(whole) {
  const { zarr_format: format, shape, chunk_grid: grid, data_type: type, codecs, fill_value: fill, chunk_key_encoding: keys, dimension_names: names } = whole;
  if (format !== 3 || !widths[type]) refuse(`Zarr arrays of type ${JSON.stringify(type)} are not read in the browser`);
  if (grid?.name !== "regular") refuse(`the chunk grid ${grid?.name} of this Zarr is not read`);
  if (keys?.name !== "default" && keys?.name !== "v2") refuse(`the chunk_key_encoding ${keys?.name} of this Zarr is not read`);
  if (whole.storage_transformers?.length > 0) refuse("the storage_transformers of this Zarr are not read");
  const separator = keys.configuration?.separator ?? (keys.name === "v2" ? "." : "/");
  const key = (at) => (keys.name === "v2" ? at : ["c", ...at]).join(separator);
  return checked({ shape, chunks: grid.configuration.chunk_shape, type, codecs, fill: fillOf(fill, type), separator, key, names });
}

const product = (list) => list.reduce((all, n) => all * n, 1);

/** True for big-endian numbers of so many bytes. The order of one has no name. */
function isBig({ configuration }, width) {
  const endian = configuration?.endian ?? (width === 1 ? "little" : "(not given)");
  if (endian !== "little" && endian !== "big") refuse(`the endian '${endian}' of this Zarr is not read`);
  return endian === "big";
}

/** The samples of a chunk of this shape, with the strides of its axes. */
async function unpacked(bytes, codecs, shape, type) {
  let order = shape.map((_, i) => i);
  let rest = [...codecs];
  if (rest[0]?.name === "transpose") {
    order = rest[0].configuration?.order;
    if (!Array.isArray(order) || order.length !== shape.length || !shape.every((_, i) => order.includes(i))) refuse("the order of the axes of this Zarr is not read");
    rest = rest.slice(1);
  }
  const [serializer, ...packers] = rest;
  if (serializer?.name !== "bytes") refuse(`chunks in ${serializer?.name} are not read in the browser`);
  const size = product(shape) * widths[type];
  let data = bytes;
  for (const { name } of packers.reverse()) data = await codecNamed(name)(data, size + 64); // checksums
  if (data.length !== size) refuse(`a chunk of this Zarr has ${data.length} bytes in place of ${size}`, "copy or download it again");
  const samples = samplesOf(data, type, isBig(serializer, widths[type]), product(shape));
  const strides = [];
  order.reduceRight((stride, axis) => {
    strides[axis] = stride;
    return stride * shape[axis];
  }, 1);
  return { samples, strides };
}

/** Of a number among `counts`, the last fastest: that of each axis. */
function placeOf(number, counts) {
  const place = [];
  counts.reduceRight((left, n, axis) => {
    place[axis] = left % n;
    return Math.floor(left / n);
  }, number);
  return place;
}

/** Where the chunks of a shard lie in it. */
function indexOf(bytes, { index_codecs: codecs, index_location: location = "end" }, entries) {
  const names = (codecs ?? []).map(({ name }) => name).join();
  if ((names !== "bytes" && names !== "bytes,crc32c") || isBig(codecs[0], 8)) refuse(`shards with an index in ${names} (big-endian or packed) are not read in the browser`);
  if (location !== "start" && location !== "end") refuse(`shards with an index at '${location}' are not read`);
  const size = 16 * entries + (names === "bytes" ? 0 : 4);
  if (bytes.length < size) refuse("a shard of this Zarr is shorter than its index", "copy or download it again");
  const whole = location === "start" ? bytes.subarray(0, size) : bytes.subarray(bytes.length - size);
  const index = names === "bytes" ? whole : crc32c(whole);
  return new DataView(index.buffer, index.byteOffset, index.byteLength);
}

/** Visits the chunks stored in an object: itself, or those of a shard; only the first ones along axes not of space. */
async function eachChunk(bytes, { codecs, chunks, type }, at, space, visit) {
  const start = at.map((n, axis) => n * chunks[axis]);
  if (codecs[0]?.name !== "sharding_indexed") return visit(await unpacked(bytes, codecs, chunks, type), start, chunks);
  if (codecs.length > 1) refuse("shards that are packed as a whole are not read in the browser");
  const inner = codecs[0].configuration;
  const shape = inner.chunk_shape;
  const counts = chunks.map((n, axis) => n / shape[axis]);
  countOf(counts);
  countOf(shape);
  const index = indexOf(bytes, inner, product(counts));
  for (let i = 0; i < product(counts); ++i) {
    const [offset, size] = [index.getBigUint64(16 * i, true), index.getBigUint64(16 * i + 8, true)];
    const from = placeOf(i, counts).map((n, axis) => start[axis] + n * shape[axis]);
    if (from.some((n, axis) => n > 0 && !space.includes(axis))) continue;
    if (offset === 0xffffffffffffffffn && size === offset) continue;
    if (offset + size > BigInt(bytes.length)) refuse("a chunk of a shard of this Zarr lies beyond its end", "copy or download it again");
    visit(await unpacked(bytes.subarray(Number(offset), Number(offset + size)), inner.codecs, shape, type), from, shape);
  }
}

/** All samples, x fastest; `space` are the axes x, y and z of the array. Other axes are taken at 0. */
async function readArray(get, path, array, space, notes) {
  const size = space.map((axis) => (axis === undefined ? 1 : array.shape[axis]));
  const sample = samplesOf(new Uint8Array(8), array.type, false, 1);
  const out = new sample.constructor(countOf(size)).fill(array.fill);
  const place = (chunk, start, shape) => {
    const [low, high] = [0, 1].map((end) => space.map((axis, a) => (axis === undefined ? end : Math.min(size[a], start[axis] + end * shape[axis]))));
    const stride = space.map((axis) => (axis === undefined ? 0 : chunk.strides[axis]));
    for (let z = low[2]; z < high[2]; ++z) {
      for (let y = low[1]; y < high[1]; ++y) {
        let from = (y - low[1]) * stride[1] + (z - low[2]) * stride[2];
        let to = low[0] + size[0] * (y + size[1] * z);
        for (let x = low[0]; x < high[0]; ++x, from += stride[0]) out[to++] = chunk.samples[from];
      }
    }
  };
  const counts = array.shape.map((n, axis) => (space.includes(axis) ? Math.ceil(n / array.chunks[axis]) : 1));
  let next = 0;
  let found = 0;
  const work = async () => {
    while (next < product(counts)) {
      const at = placeOf(next++, counts);
      const bytes = await get(path + array.key(at), false);
      if (!bytes) continue;
      ++found;
      await eachChunk(bytes, array, at, space, place);
    }
  };
  await Promise.all(Array.from({ length: 8 }, work));
  // They may have other names than the metadata say, which the native program finds out.
  if (found === 0) refuse(`this Zarr has no chunk that is named ${path + array.key(array.shape.map(() => 0))}, or alike`);
  return finite(out, notes);
}

/** Where x, y and z are among axes named t, c, z, y and x. */
function spaceOf(names, count) {
  const all = names.every((name, i) => ["t", "c", "z", "y", "x"].includes(name) && names.indexOf(name) === i);
  if (names.length !== count || !all || !names.includes("x") || !names.includes("y")) refuse(`the axes '${names.join(", ")}' of this Zarr, of ${count} dimensions, are not t, c, z, y, x`);
  return ["x", "y", "z"].map((name) => (names.includes(name) ? names.indexOf(name) : undefined));
}

/** OME-Zarr tells the kind of channels and times, and before 0.3 nothing. */
const namesOfImage = ({ axes = ["t", "c", "z", "y", "x"] }) => axes.map((axis) => ({ time: "t", channel: "c" })[axis.type] ?? axis.name ?? axis);
function namesOfArray({ array, attributes }) {
  const names = array.names ?? attributes._ARRAY_DIMENSIONS;
  const usual = array.shape.length > 5 ? [] : ["t", "c", "z", "y", "x"].slice(-array.shape.length);
  return names ? names.map((name) => String(name).toLowerCase()) : usual;
}

/** An image of version 0.6, whose axes are in a coordinate system, in the words of earlier versions. Transformations of
 * the whole image lead to other systems there, and are left out. */
function withAxes(image, notes) {
  const systems = image?.coordinateSystems;
  if (!Array.isArray(systems) || systems.length === 0) return image;
  const output = image.datasets?.[0]?.coordinateTransformations?.[0]?.output;
  const system = systems.find(({ name }) => name === (output?.name ?? output)) ?? systems[0];
  if (image.coordinateTransformations?.length > 0) notes.push("it has further transformations, from the space of its levels to others: they were not applied");
  return { ...image, axes: system.axes, coordinateTransformations: undefined };
}

/** A scale, and a translation after it. Version 0.6 puts both into a sequence. */
function transformed({ coordinateTransformations: given = [] }, count) {
  const list = given?.[0]?.type === "sequence" && given.length === 1 ? given[0].transformations : given;
  if (!Array.isArray(list)) refuse("the transformations of this OME-Zarr are no list");
  const steps = list.filter(({ type }) => type !== "identity");
  const kinds = steps.map(({ type }) => type).join();
  if (!["", "scale", "translation", "scale,translation"].includes(kinds)) refuse(`the transformations '${kinds}' of this OME-Zarr are not read`);
  const numbers = (type, otherwise) => {
    const given = steps.find((one) => one.type === type);
    const found = given ? given[type] : new Array(count).fill(otherwise);
    if (!Array.isArray(found) || found.length !== count || !found.every(Number.isFinite)) refuse(`the ${type} of this OME-Zarr has not ${count} numbers`);
    return found;
  };
  return { scale: numbers("scale", 1), shift: numbers("translation", 0) };
}

function unitOf({ unit = "" }, notes) {
  const note = "it gives no unit of length: mm were taken";
  if (unit === "" && !notes.includes(note)) notes.push(note);
  return Object.hasOwn(millimetres, unit) ? millimetres[unit] : refuse(`the unit of length '${unit}' is not read`);
}

/** Where a level lies. */
function geometryOfLevel({ level, array, space }, image, columns, notes) {
  const size = space.map((axis) => array.shape[axis] ?? 1);
  const [inner, outer] = [level, image ?? {}].map((one) => transformed(one, array.shape.length));
  const unit = space.map((axis) => (image && axis !== undefined ? unitOf(image.axes?.[axis] ?? {}, notes) : 1));
  const spacing = space.map((axis, a) => (axis === undefined ? 1 : inner.scale[axis] * outer.scale[axis] * unit[a]));
  const origin = space.map((axis, a) => (axis === undefined ? 0 : (outer.scale[axis] * inner.shift[axis] + outer.shift[axis]) * unit[a]));
  if (!spacing.every((s) => s > 0)) refuse(`the scale of this OME-Zarr gives a spacing of ${spacing.join(" x ")} mm`);
  const axes = spacing.map((s, a) => columns.slice(3 * a, 3 * a + 3).map((x) => x * s));
  return { ...geometryOf(size, axes, origin), spacing };
}

/** True if a level is as large as the finest one, and lies there. Sizes are rounded either way, and scales to some digits. */
function agree(level, finest) {
  const extent = ({ size, spacing }) => size.map((n, a) => n * spacing[a]);
  const [whole, given] = [finest, level].map(extent);
  const apart = level.origin.map((x, row) => x - finest.origin[row]);
  return [0, 1, 2].every((a) => {
    const most = 1.001 * Math.max(level.spacing[a], finest.spacing[a], whole[a] / 100);
    const along = [0, 1, 2].reduce((sum, row) => sum + finest.direction[3 * row + a] * apart[row], 0);
    const corner = along - (level.spacing[a] - finest.spacing[a]) / 2;
    return Math.abs(given[a] - whole[a]) <= most && Math.abs(corner) <= most;
  });
}

/** The levels of an image, or the array alone, from fine to coarse. */
async function levelsOf(get, path, { array: alone }, image, names, notes) {
  const listed = await Promise.all((image?.datasets ?? [{ path: "" }]).map(async (level) => {
    const below = path + (level.path ? `${level.path}/` : "");
    const array = image ? (await node(get, below)).array : alone;
    if (!array) refuse(`level ${level.path} of this OME-Zarr is missing`, "copy or download it again");
    return { level, below, array, space: spaceOf(names, array.shape.length) };
  }));
  if (listed.some(({ array }) => array.type !== listed[0].array.type)) refuse("the levels of this OME-Zarr have different types");
  const levels = [...listed].sort((one, other) => product(other.array.shape) - product(one.array.shape));
  if (levels.some((one, i) => one !== listed[i])) notes.push("its levels were not listed from fine to coarse: they were sorted");
  return levels;
}

/** The finest level of at most `mostSamples`, and its geometry. */
function chosenOf(levels, image, columns, notes) {
  const isSmall = ({ array, space }) => product(space.map((axis) => array.shape[axis] ?? 1)) <= mostSamples;
  const [finest] = levels;
  const isScaled = levels.some(({ level }) => level.coordinateTransformations?.some(({ type }) => type === "scale" || type === "sequence"));
  if (!isSmall(finest) && levels.length > 1 && !isScaled) refuse("this OME-Zarr does not tell the scales of its levels, and the finest is too large");
  const placed = levels.map((one) => ({ ...one, geometry: geometryOfLevel(one, image, columns, notes) }));
  const agreeing = placed.filter(({ geometry }) => agree(geometry, placed[0].geometry));
  const chosen = agreeing.find(isSmall) ?? agreeing.at(-1);
  const number = placed.indexOf(chosen);
  if (number > 0) notes.push(`of ${levels.length} levels, ${number} was taken: finer ones are too large`);
  if (number > 0 && agreeing.length < levels.length) notes.push("levels were left out: by their scale or translation they are not where the finest is");
  return chosen;
}

async function read(get, path, notes) {
  const root = await node(get, path);
  const metadata = root.attributes.ome ?? root.attributes;
  if (!root.array && metadata["bioformats2raw.layout"] !== undefined && !metadata.multiscales) {
    return read(get, `${path}0/`, ["of the series in it, 0 was taken"]);
  }
  const image = root.array ? null : withAxes(metadata.multiscales?.[0], notes);
  if (!root.array && !image) refuse("this is no Zarr array and no OME-Zarr", "choose the folder that has one, or a file named .nrrd, .nii, .nii.gz or .dcm");
  if (image && metadata.multiscales.length > 1) notes.push(`of ${metadata.multiscales.length} images in it, the first was taken`);
  const names = image ? namesOfImage(image) : namesOfArray(root);
  const ours = (image && root.attributes.palpate) || {}; // written by `palpate convert`: columns
  const columns = ours.direction ?? [1, 0, 0, 0, 1, 0, 0, 0, 1];
  if (columns.length !== 9 || !columns.every(Number.isFinite)) refuse("the direction of this OME-Zarr has not nine numbers");
  const { below, array, space, geometry } = chosenOf(await levelsOf(get, path, root, image, names, notes), image, columns, notes);
  for (const [name, what] of [["c", "channels"], ["t", "times"]]) {
    const count = array.shape[names.indexOf(name)] ?? 1;
    if (count > 1) notes.push(`of ${count} ${what}, 0 was taken`);
  }
  if (!image) notes.push("it is an array without a place in space: 1 mm was taken");
  const unused = ["scale_factor", "add_offset"].filter((name) => !image && root.attributes[name] !== undefined);
  if (unused.length > 0) notes.push(`its ${unused.join(" and ")} were not applied: the samples are as they are stored`);
  const samples = await readArray(get, below, array, space, notes);
  return { samples, geometry, oriented: ours.direction !== undefined && ours.oriented !== false, notes };
}

/** Samples, geometry, whether it is that of a body, and notes on what was chosen and assumed. */
export async function readZarr(get) {
  return read(get, "", []).catch((error) => {
    // What it lacks was looked for in vain, or its bytes are no packed ones.
    if (error instanceof TypeError || error instanceof RangeError) refuse(`this Zarr is damaged, or lacks what it needs (${error.message})`, "copy or download it again");
    throw error;
  });
}
