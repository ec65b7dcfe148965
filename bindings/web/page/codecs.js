// Unpacks the chunks of Zarr arrays: gzip, zlib, lz4, zstd and blosc. Bytes in, bytes out, `most` of them.
import { inflated } from "../inflated.js";
import { refuse } from "./files.js";

const damaged = (what) => refuse(what, "copy or download it again");
const bounded = (size, most) => (size <= most ? size : damaged(`a chunk unpacks to ${size} bytes, more than its array has in one`));

const primes = [0x9e3779b185ebca87n, 0xc2b2ae3d27d4eb4fn, 0x165667b19e3779f9n, 0x85ebca77c2b2ae63n, 0x27d4eb2f165667c5n];
const whole = (x) => BigInt.asUintN(64, x);
const turned = (x, bits) => whole(x << bits) | (x >> (64n - bits));
const mixed = (sum, lane) => whole(turned(whole(sum + lane * primes[1]), 31n) * primes[0]);

/** The lower half of XXH64 with the seed 0 (https://github.com/Cyan4973/xxHash). */
export function xxh64(bytes) {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  let at = 0;
  let sum = primes[4];
  if (bytes.length >= 32) {
    let [a, b, c, d] = [whole(primes[0] + primes[1]), primes[1], 0n, whole(-primes[0])];
    for (; at + 32 <= bytes.length; at += 32) {
      a = mixed(a, view.getBigUint64(at, true));
      b = mixed(b, view.getBigUint64(at + 8, true));
      c = mixed(c, view.getBigUint64(at + 16, true));
      d = mixed(d, view.getBigUint64(at + 24, true));
    }
    sum = whole(turned(a, 1n) + turned(b, 7n) + turned(c, 12n) + turned(d, 18n));
    for (const lane of [a, b, c, d]) sum = whole((sum ^ mixed(0n, lane)) * primes[0] + primes[3]);
  }
  sum = whole(sum + BigInt(bytes.length));
  for (; at + 8 <= bytes.length; at += 8) sum = whole(turned(sum ^ mixed(0n, view.getBigUint64(at, true)), 27n) * primes[0] + primes[3]);
  for (; at + 4 <= bytes.length; at += 4) sum = whole(turned(sum ^ whole(BigInt(view.getUint32(at, true)) * primes[0]), 23n) * primes[1] + primes[2]);
  for (; at < bytes.length; ++at) sum = whole(turned(sum ^ whole(BigInt(bytes[at]) * primes[4]), 11n) * primes[0]);
  sum = whole((sum ^ (sum >> 33n)) * primes[1]);
  sum = whole((sum ^ (sum >> 29n)) * primes[2]);
  return Number((sum ^ (sum >> 32n)) & 0xffffffffn);
}

/** fzstd does not look at the checksum, which is there if the frame says so (RFC 8878). */
async function zstd(bytes) {
  const { decompress } = await import("./fzstd.js").catch(() => {
    throw new Error("fzstd.js, which unpacks zstd, is not beside this page");
  });
  const data = decompress(bytes);
  const hasSum = bytes[4] & 4;
  if (hasSum && new DataView(bytes.buffer, bytes.byteOffset).getUint32(bytes.length - 4, true) !== xxh64(data)) damaged("the checksum (zstd) of a chunk is not that of its bytes");
  return data;
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

/** zarr-python calls them as numcodecs does, with a prefix. */
export const codecNamed = (name) => codecs[name.replace(/^numcodecs\./, "")] ?? refuse(`chunks packed with ${name} are not read in the browser`);
