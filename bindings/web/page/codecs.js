// Unpacks the chunks of Zarr arrays: gzip, zlib, lz4, zstd and blosc. Bytes in, bytes out.
import { inflated } from "./files.js";

async function zstd(bytes) {
  const { decompress } = await import("./fzstd.js").catch(() => {
    throw new Error("fzstd.js, which unpacks zstd, is not beside this page");
  });
  return decompress(bytes);
}

/** A block of lz4, which has `size` bytes unpacked. */
export function lz4(bytes, size) {
  const out = new Uint8Array(size);
  let [at, to] = [0, 0];
  const length = (nibble) => {
    let sum = nibble;
    for (let byte = 255; nibble === 15 && byte === 255; sum += byte) byte = bytes[at++];
    return sum;
  };
  while (at < bytes.length) {
    const token = bytes[at++];
    const literals = length(token >> 4);
    if (at + literals > bytes.length || to + literals > size) throw new Error("a chunk of lz4 is damaged");
    out.set(bytes.subarray(at, at + literals), to);
    at += literals;
    to += literals;
    if (at >= bytes.length) break;
    const back = bytes[at] | (bytes[at + 1] << 8);
    at += 2;
    const copied = length(token & 15) + 4;
    if (back === 0 || back > to || to + copied > size) throw new Error("a chunk of lz4 is damaged");
    for (let i = 0; i < copied; ++i, ++to) out[to] = out[to - back];
  }
  if (to !== size) throw new Error("a chunk of lz4 ends early");
  return out;
}

function unshuffled(block, width) {
  const out = block.slice();
  const count = Math.floor(block.length / width);
  for (let byte = 0; byte < width; ++byte) {
    for (let i = 0; i < count; ++i) out[i * width + byte] = block[byte * count + i];
  }
  return out;
}

/** The first bits of all elements, then the second ones, ... `format` is that of blosc: in 2, a block of which eight
 * are no divisor is stored as it is; later, only the elements that remain. */
function bitUnshuffled(block, width, format) {
  const out = block.slice();
  const whole = Math.floor(block.length / width);
  if (format <= 2 && whole % 8 !== 0) return out;
  const count = whole - (whole % 8);
  out.fill(0, 0, count * width);
  for (let bit = 0; bit < 8 * width; ++bit) {
    const row = (bit * count) / 8;
    for (let i = 0; i < count; ++i) out[i * width + (bit >> 3)] |= ((block[row + (i >> 3)] >> (i & 7)) & 1) << (bit & 7);
  }
  return out;
}

async function blosc(bytes) {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const [flags, width] = [bytes[2], bytes[3]];
  const [size, blockSize] = [view.getUint32(4, true), view.getUint32(8, true)];
  if (flags & 2) return bytes.subarray(16, 16 + size); // stored
  const codec = { 1: lz4, 3: (part) => inflated(part, "deflate"), 4: zstd }[flags >> 5];
  if (!codec) throw new Error(`blosc with ${["blosclz", "", "snappy"][flags >> 5] ?? "an unknown codec"} is not read in the browser`);
  const out = new Uint8Array(size);
  for (let block = 0; block * blockSize < size; ++block) {
    const length = Math.min(blockSize, size - block * blockSize);
    const isSplit = !(flags & 16) && width <= 16 && blockSize / width >= 128 && length === blockSize;
    const part = isSplit ? length / width : length;
    const unpacked = new Uint8Array(length);
    let at = view.getInt32(16 + 4 * block, true);
    for (let to = 0; to < length; to += part) {
      const packed = view.getInt32(at, true);
      const data = bytes.subarray(at + 4, at + 4 + packed);
      if (packed < 0 || data.length !== packed) throw new Error("a chunk of blosc is damaged");
      unpacked.set(packed === part ? data : await codec(data, part), to);
      at += 4 + packed;
    }
    const shuffled = flags & 1 && width > 1 ? unshuffled(unpacked, width) : flags & 4 ? bitUnshuffled(unpacked, width, bytes[0]) : unpacked;
    out.set(shuffled, block * blockSize);
  }
  return out;
}

const codecs = {
  gzip: (bytes) => inflated(bytes, "gzip"),
  zlib: (bytes) => inflated(bytes, "deflate"),
  zstd,
  blosc,
  /** As numcodecs writes it: the size comes first. */
  lz4: (bytes) => lz4(bytes.subarray(4), new DataView(bytes.buffer, bytes.byteOffset).getUint32(0, true)),
  crc32c: (bytes) => bytes.subarray(0, bytes.length - 4), // not checked
};

export function codecNamed(name) {
  const codec = codecs[name];
  if (!codec) throw new Error(`chunks packed with ${name} are not read in the browser`);
  return codec;
}
