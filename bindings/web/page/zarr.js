// Reads a level of an OME-Zarr (0.4, 0.5), or a Zarr array, into samples and a geometry. `get(path)` gives the bytes of
// an object below the root, or null: from dropped files, or from a server.
import { codecNamed } from "./codecs.js";
import { samplesOf } from "./files.js";

const mostSamples = 2 ** 25; // finer levels are left out
const millimetres = { angstrom: 1e-7, nanometer: 1e-6, micrometer: 1e-3, millimeter: 1, centimeter: 10, meter: 1000 };
const typesOfZarr2 = { u1: "uint8", i1: "int8", u2: "uint16", i2: "int16", u4: "uint32", i4: "int32", f4: "float32", f8: "float64" };
const widths = { uint8: 1, int8: 1, uint16: 2, int16: 2, uint32: 4, int32: 4, float32: 4, float64: 8 };

async function json(get, path) {
  const bytes = await get(path);
  return bytes && JSON.parse(new TextDecoder().decode(bytes));
}

/** Metadata of a group or an array: Zarr 3, else Zarr 2. */
async function node(get, path) {
  const whole = await json(get, `${path}zarr.json`);
  if (whole) return { array: whole.node_type === "array" ? described3(whole) : null, attributes: whole.attributes ?? {} };
  const [array, attributes] = await Promise.all([json(get, `${path}.zarray`), json(get, `${path}.zattrs`)]);
  return { array: array && described2(array), attributes: attributes ?? {} };
}

function described2({ shape, chunks, dtype, compressor, filters, fill_value: fill, order, dimension_separator: separator = "." }) {
  const type = typesOfZarr2[dtype?.slice?.(1)];
  if (!type) throw new Error(`Zarr arrays of type ${dtype} are not read in the browser`);
  if (filters?.length > 0) throw new Error(`the filter ${filters[0].id} of this Zarr is not read in the browser`);
  const codecs = [{ name: "bytes", configuration: { endian: dtype[0] === ">" ? "big" : "little" } }];
  if (order === "F") codecs.unshift({ name: "transpose", configuration: { order: shape.map((_, i) => shape.length - 1 - i) } });
  if (compressor) codecs.push({ name: compressor.id });
  return { shape, chunks, type, codecs, fill: Number(fill ?? 0), key: (at) => at.join(separator) };
}

function described3({ shape, chunk_grid: grid, data_type: type, codecs, fill_value: fill, chunk_key_encoding: keys, dimension_names: names }) {
  if (!widths[type]) throw new Error(`Zarr arrays of type ${type} are not read in the browser`);
  if (grid.name !== "regular") throw new Error(`the chunk grid ${grid.name} of this Zarr is not read`);
  const isOld = keys?.name === "v2";
  const separator = keys?.configuration?.separator ?? (isOld ? "." : "/");
  const key = (at) => (isOld ? at : ["c", ...at]).join(separator);
  return { shape, chunks: grid.configuration.chunk_shape, type, codecs, fill: Number(fill ?? 0), key, names };
}

const product = (list) => list.reduce((all, n) => all * n, 1);

/** The samples of a chunk of this shape, with the strides of its axes. */
async function unpacked(bytes, codecs, shape, type) {
  let order = shape.map((_, i) => i);
  let rest = [...codecs];
  if (rest[0]?.name === "transpose") {
    ({ order } = rest[0].configuration);
    rest = rest.slice(1);
  }
  const [serializer, ...packers] = rest;
  if (serializer?.name !== "bytes") throw new Error(`chunks in ${serializer?.name} are not read in the browser`);
  let data = bytes;
  for (const { name } of packers.reverse()) data = await codecNamed(name)(data);
  const samples = samplesOf(data, type, serializer.configuration?.endian === "big", product(shape));
  const strides = [];
  order.reduceRight((stride, axis) => {
    strides[axis] = stride;
    return stride * shape[axis];
  }, 1);
  return { samples, strides };
}

/** Visits the chunks stored in an object: itself, or those of a shard. */
async function eachChunk(bytes, { codecs, chunks, type }, at, visit) {
  const [shard] = codecs;
  const start = at.map((n, axis) => n * chunks[axis]);
  if (shard?.name !== "sharding_indexed") return visit(await unpacked(bytes, codecs, chunks, type), start, chunks);
  const inner = shard.configuration;
  const counts = chunks.map((n, axis) => n / inner.chunk_shape[axis]);
  const checked = inner.index_codecs.some(({ name }) => name === "crc32c") ? 4 : 0;
  const entries = product(counts);
  const begin = inner.index_location === "start" ? 0 : bytes.length - 16 * entries - checked;
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  for (let i = 0; i < entries; ++i) {
    const [offset, size] = [view.getBigUint64(begin + 16 * i, true), view.getBigUint64(begin + 16 * i + 8, true)];
    if (offset === 0xffffffffffffffffn) continue;
    const place = [];
    counts.reduceRight((left, n, axis) => {
      place[axis] = left % n;
      return Math.floor(left / n);
    }, i);
    const data = bytes.subarray(Number(offset), Number(offset + size));
    const chunk = await unpacked(data, inner.codecs, inner.chunk_shape, type);
    visit(chunk, place.map((n, axis) => start[axis] + n * inner.chunk_shape[axis]), inner.chunk_shape);
  }
}

/** All samples, x fastest; `space` are the axes x, y and z of the array. Other axes are taken at 0. */
async function readArray(get, path, array, space) {
  const size = space.map((axis) => (axis === undefined ? 1 : array.shape[axis]));
  const sample = samplesOf(new Uint8Array(8), array.type, false, 1);
  const out = new sample.constructor(product(size)).fill(array.fill);
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
  const work = async () => {
    while (next < product(counts)) {
      const at = [];
      counts.reduceRight((left, n, axis) => {
        at[axis] = left % n;
        return Math.floor(left / n);
      }, next++);
      const bytes = await get(path + array.key(at));
      if (bytes) await eachChunk(bytes, array, at, place);
    }
  };
  await Promise.all(Array.from({ length: 8 }, work));
  return { size, samples: finite(out) };
}

/** Samples that are no number become the least one. */
function finite(samples) {
  if (!(samples instanceof Float32Array)) return samples;
  const least = samples.reduce((low, v) => (Number.isFinite(v) && v < low ? v : low), Infinity);
  return samples.map((v) => (Number.isFinite(v) ? v : Number.isFinite(least) ? least : 0));
}

/** Of an axis list: where x, y and z are. */
function spaceOf(names, count) {
  if (names && names.every((name) => typeof name === "string")) {
    const space = ["x", "y", "z"].map((name) => (names.includes(name) ? names.indexOf(name) : undefined));
    if (space[0] !== undefined && space[1] !== undefined) return space;
  }
  if (count < 2) throw new Error("this Zarr array has fewer than two axes");
  return [count - 1, count - 2, count > 2 ? count - 3 : undefined];
}

function transformed(lists, count) {
  let [scale, shift] = [new Array(count).fill(1), new Array(count).fill(0)];
  for (const one of lists.flat()) {
    if (one.type === "scale") [scale, shift] = [scale.map((s, i) => s * one.scale[i]), shift.map((t, i) => t * one.scale[i])];
    else if (one.type === "translation") shift = shift.map((t, i) => t + one.translation[i]);
    else if (one.type !== "identity") throw new Error(`the transformation ${one.type} of this OME-Zarr is not read`);
  }
  return { scale, shift };
}

export async function readZarr(get, path = "") {
  const root = await node(get, path);
  const metadata = root.attributes.ome ?? root.attributes;
  if (!root.array && metadata["bioformats2raw.layout"] !== undefined && !metadata.multiscales) return readZarr(get, `${path}0/`);
  const image = metadata.multiscales?.[0];
  if (!root.array && !image) throw new Error("this is no Zarr array and no OME-Zarr");
  const levels = image ? image.datasets : [{ path: "", coordinateTransformations: [] }];
  let chosen = null;
  for (const level of levels) {
    const below = path + (level.path ? `${level.path}/` : "");
    const array = level.path ? (await node(get, below)).array : root.array;
    if (!array) throw new Error(`level ${level.path} of this OME-Zarr is missing`);
    const names = image?.axes?.map((axis) => axis.name ?? axis) ?? array.names;
    const space = spaceOf(names, array.shape.length);
    chosen = { level, below, array, space };
    if (product(space.map((axis) => (axis === undefined ? 1 : array.shape[axis]))) <= mostSamples) break;
  }
  const { level, below, array, space } = chosen;
  const voxels = product(space.map((axis) => (axis === undefined ? 1 : array.shape[axis])));
  if (voxels > 4 * mostSamples) throw new Error(`this Zarr has ${(voxels / 2 ** 20).toFixed(0)} million samples and no coarser level: too many for a page`);
  const { size, samples } = await readArray(get, below, array, space);
  const { scale, shift } = transformed([level.coordinateTransformations ?? [], image?.coordinateTransformations ?? []], array.shape.length);
  const unit = space.map((axis) => (axis === undefined ? 1 : millimetres[image?.axes?.[axis]?.unit] ?? 1));
  const inSpace = (list, otherwise) => space.map((axis, a) => (axis === undefined ? otherwise : list[axis] * unit[a]));
  return { samples, geometry: { size, spacing: inSpace(scale, 1), origin: inSpace(shift, 0), direction: [1, 0, 0, 0, 1, 0, 0, 0, 1] } };
}
