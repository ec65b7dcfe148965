// Unpacks the chunks of Zarr arrays: gzip, zlib, lz4, zstd and blosc. Bytes in, bytes out, `most` of them.
import { inflated, refuse } from "./files.js";

const damaged = (what) => refuse(what, "copy or download it again");
const bounded = (size, most) => (size <= most ? size : damaged(`a chunk unpacks to ${size} bytes, more than its array has in one`));

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
    if (at + literals > bytes.length || to + literals > size) damaged("a chunk of lz4 is damaged");
    out.set(bytes.subarray(at, at + literals), to);
    at += literals;
    to += literals;
    if (at >= bytes.length) break;
    const back = bytes[at] | (bytes[at + 1] << 8);
    at += 2;
    const copied = length(token & 15) + 4;
    if (back === 0 || back > to || to + copied > size) damaged("a chunk of lz4 is damaged");
    for (let i = 0; i < copied; ++i, ++to) out[to] = out[to - back];
  }
  if (to !== size) damaged("a chunk of lz4 ends early");
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

async function blosc(bytes, most) {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const [flags, width] = [bytes[2], bytes[3]];
  const [size, blockSize] = [bounded(view.getUint32(4, true), most), view.getUint32(8, true)];
  if (flags & 8) refuse("blosc with the filter delta is not read in the browser");
  if (flags & 2) return bytes.subarray(16, 16 + size); // stored
  if (blockSize === 0 || width === 0) damaged("a chunk of blosc is damaged");
  const codec = { 1: lz4, 3: (part, room) => inflated(part, "deflate", room), 4: zstd }[flags >> 5];
  if (!codec) refuse(`blosc with ${["blosclz", "", "snappy"][flags >> 5] ?? "an unknown codec"} is not read in the browser`);
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
      if (packed < 0 || data.length !== packed) damaged("a chunk of blosc is damaged");
      unpacked.set(packed === part ? data : await codec(data, part), to);
      at += 4 + packed;
    }
    const shuffled = flags & 1 && width > 1 ? unshuffled(unpacked, width) : flags & 4 ? bitUnshuffled(unpacked, width, bytes[0]) : unpacked;
    out.set(shuffled, block * blockSize);
  }
  return out;
}

const crcTable = Int32Array.from({ length: 256 }, (_, n) => {
  for (let bit = 0; bit < 8; ++bit) n = n & 1 ? (n >>> 1) ^ 0x82f63b78 : n >>> 1;
  return n;
});
/** The bytes before their checksum (Castagnoli, RFC 3720). */
export function crc32c(bytes) {
  const end = bytes.length - 4;
  if (end < 0) damaged("a chunk is shorter than its checksum");
  let sum = -1;
  for (let i = 0; i < end; ++i) sum = crcTable[(sum ^ bytes[i]) & 255] ^ (sum >>> 8);
  if (new DataView(bytes.buffer, bytes.byteOffset).getInt32(end, true) !== ~sum) damaged("the checksum (crc32c) of a chunk is not that of its bytes");
  return bytes.subarray(0, end);
}

const codecs = {
  gzip: (bytes, most) => inflated(bytes, "gzip", most),
  zlib: (bytes, most) => inflated(bytes, "deflate", most),
  zstd,
  blosc,
  /** As numcodecs writes it: the size comes first. */
  lz4: (bytes, most) => lz4(bytes.subarray(4), bounded(new DataView(bytes.buffer, bytes.byteOffset).getUint32(0, true), most)),
  crc32c,
};

export const codecNamed = (name) => codecs[name] ?? refuse(`chunks packed with ${name} are not read in the browser`);
