// Files that the module reads by the native readers: what JavaScript adds to them. opening.test.mjs compares their results
// with those of the native program.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import test from "node:test";
import { deflateSync, gzipSync } from "node:zlib";

const { load } = await import(join(process.env.PALPATE_WEB, "palpate.js"));
const palpate = await load();
const bytesOf = (text) => new TextEncoder().encode(text);
const joined = (...parts) => new Uint8Array(Buffer.concat(parts));
const samples = Uint8Array.of(1, 2, 3, 4);

/** 1 x 2 x 2 samples. */
const nrrd = (...fields) => bytesOf(["NRRD0004", "type: uchar", "dimension: 3", "sizes: 1 2 2", "spacings: 1 2 3", ...fields, "", ""].join("\n"));
const mha = (data) => joined(bytesOf(`NDims = 3\nDimSize = 1 2 2\nElementType = MET_UCHAR\nCompressedData = True\nCompressedDataSize = ${data.length}\nElementDataFile = LOCAL\n`), data);

test("the head has the samples and the geometry of its header", async () => {
  const bytes = new Uint8Array(readFileSync(join(process.env.PALPATE_SOURCE, "data", "visible_human_head.nrrd")));
  const { volume, oriented, format } = await palpate.read([{ path: "head.nrrd", bytes }]);
  const { size, spacing, origin, direction } = volume;
  assert.equal(volume.samples().length, 96 * 108 * 110);
  assert.deepEqual({ size, spacing, origin, direction }, { size: [96, 108, 110], spacing: [2, 2, 2], origin: [152.5, 128.5, 14.5], direction: [1, 0, 0, 0, 1, 0, 0, 0, 1] });
  assert.deepEqual([oriented, format], [true, "NRRD"]);
});

test("gzip, zlib and samples in a file of their own are found, and nothing stays behind", async () => {
  const header = { path: "a/head.nhdr", bytes: nrrd("encoding: gzip", "data file: head.gz") };
  const several = await palpate.read([{ path: "a/head.gz", bytes: gzipSync(samples) }, header], header.path);
  const whole = await palpate.read([{ path: "a.nrrd.mha", bytes: mha(deflateSync(samples)) }]);
  for (const { volume } of [several, whole]) assert.deepEqual(volume.samples(), samples);
  assert.deepEqual(several.volume.spacing, [1, 2, 3]);
  assert.deepEqual(palpate.core.givenFiles.open, []);
});

test("files that are read at the same time do not meet", async () => {
  const read = (byte) => palpate.read([{ path: "a.nrrd", bytes: joined(nrrd("encoding: gzip"), gzipSync(samples.map((x) => x + byte))) }]);
  const all = await Promise.all([read(0), read(10), read(20)]);
  assert.deepEqual(all.map(({ volume }) => volume.samples()[0]), [1, 11, 21]);
});

test("a file that is damaged, ends early or is of another format is refused with the reason", async () => {
  const refused = (path, bytes, pattern) => assert.rejects(palpate.read([{ path, bytes }]), pattern);
  const packed = gzipSync(samples);
  await refused("a.nrrd", joined(nrrd("encoding: raw"), samples.subarray(1)), /^Error: a\.nrrd: its header asks for 4 bytes of samples, there are 3/);
  await refused("a.nrrd", joined(nrrd("encoding: gzip"), packed.with(packed.length - 5, packed.at(-5) ^ 1)), /^Error: a\.nrrd: the compressed data is damaged, or has several parts; copy/);
  await refused("a.nii.gz", packed.subarray(0, 12), /^Error: a\.nii\.gz: the compressed data is damaged/);
  await refused("a.txt", bytesOf("not a volume"), /^Error: a\.txt: is of no format that is read in the browser .*convert it first/);
  assert.deepEqual(palpate.core.givenFiles.open, []);
});
