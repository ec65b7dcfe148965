// Files that the page reads: samples and their place in space.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import test from "node:test";
import { gzipSync } from "node:zlib";

const { readVolume } = await import(join(process.env.PALPATE_WEB, "page", "files.js"));
const read = (buffer) => readVolume(new Uint8Array(buffer).buffer);

test("the head has the samples and the geometry of its header", async () => {
  const { samples, geometry } = await read(readFileSync(join(process.env.PALPATE_SOURCE, "data", "visible_human_head.nrrd")));
  assert.equal(samples.length, 96 * 108 * 110);
  assert.deepEqual(geometry, { size: [96, 108, 110], spacing: [2, 2, 2], origin: [152.5, 128.5, 14.5], direction: [1, 0, 0, 0, 1, 0, 0, 0, 1] });
});

/** 2 x 3 x 4 samples 0, 1, ... of int16, spacing 1, 2, 3, with an sform, a qform or neither. */
function nifti({ sform = true, placed = true, little = true, slope = 0, intercept = 0, units = 0, frames = 1 }) {
  const view = new DataView(new ArrayBuffer(352 + 48));
  view.setInt32(0, 348, little);
  [4, 2, 3, 4, frames].forEach((n, i) => view.setInt16(40 + 2 * i, n, little));
  view.setInt16(70, 4, little);
  [1, 1, 2, 3].forEach((x, i) => view.setFloat32(76 + 4 * i, x, little));
  view.setFloat32(108, 352, little);
  view.setFloat32(112, slope, little);
  view.setFloat32(116, intercept, little);
  view.setUint8(123, units);
  if (placed) view.setInt16(sform ? 254 : 252, 1, little);
  if (sform) [1, 0, 0, 10, 0, 2, 0, 20, 0, 0, 3, 30].forEach((x, i) => view.setFloat32(280 + 4 * i, x, little));
  else [0, 0, 0, 10, 20, 30].forEach((x, i) => view.setFloat32(256 + 4 * i, x, little));
  [..."n+1"].forEach((c, i) => view.setUint8(344 + i, c.charCodeAt(0)));
  for (let i = 0; i < 24; ++i) view.setInt16(352 + 2 * i, i, little);
  return view.buffer;
}

test("NIfTI is read from RAS into LPS, of either byte order, with sform or qform", async () => {
  for (const sform of [true, false]) {
    for (const little of [true, false]) {
      const { samples, geometry } = await read(gzipSync(new Uint8Array(nifti({ sform, little }))));
      assert.deepEqual(samples, Int16Array.from({ length: 24 }, (_, i) => i));
      assert.deepEqual([geometry.size, geometry.spacing, geometry.origin], [[2, 3, 4], [1, 2, 3], [-10, -20, 30]]);
      assert.deepEqual(geometry.direction.map((x) => x + 0), [-1, 0, 0, 0, -1, 0, 0, 0, 1]);
    }
  }
});

test("NIfTI's slope scales samples; none is given by 0, NaN or infinity", async () => {
  const first = async (header) => (await read(nifti(header))).samples.slice(0, 3);
  assert.deepEqual(await first({ slope: 2, intercept: 1 }), Float32Array.of(1, 3, 5));
  for (const slope of [0, NaN, Infinity]) assert.deepEqual(await first({ slope, intercept: NaN }), Int16Array.of(0, 1, 2));
  await assert.rejects(read(nifti({ slope: 2, intercept: NaN })), /intercept NaN/);
});

test("NIfTI without sform and qform keeps the directions of its axes", async () => {
  const { geometry } = await read(nifti({ placed: false }));
  assert.deepEqual(geometry, { size: [2, 3, 4], spacing: [1, 2, 3], origin: [0, 0, 0], direction: [1, 0, 0, 0, 1, 0, 0, 0, 1] });
});

test("NIfTI's unit of length is applied to spacing and origin", async () => {
  for (const [units, mm] of [[1, 1000], [2, 1], [3, 0.001], [2 + 8, 1]]) {
    for (const sform of [true, false]) {
      const { geometry } = await read(nifti({ sform, units }));
      assert.deepEqual([geometry.spacing, geometry.origin], [[mm, 2 * mm, 3 * mm], [-10 * mm, -20 * mm, 30 * mm]]);
    }
  }
  await assert.rejects(read(nifti({ units: 5 })), /unit of length 'number 5'/);
});

test("NIfTI of four dimensions is refused, unless the fourth has one sample", async () => {
  await assert.rejects(read(nifti({ frames: 2 })), /only NIfTI files of three dimensions/);
  assert.deepEqual((await read(nifti({ frames: 1 }))).geometry.size, [2, 3, 4]);
});

/** 1 x 1 x 2 samples. */
const nrrd = (...fields) =>
  new TextEncoder().encode(["NRRD0004", "type: uchar", "dimension: 3", "sizes: 1 1 2", "encoding: raw", ...fields, "", "ab"].join("\n"));

test("what NRRD says of skipped data and units is applied or refused", async () => {
  const placed = ["space: LPS", "space directions: (1,0,0) (0,2,0) (0,0,3)", "space origin: (4,5,6)"];
  const { samples, geometry } = await read(nrrd(...placed, 'space units: "m" "mm" "um"', "byte skip: 0", "line skip: 0"));
  assert.deepEqual(samples, Uint8Array.of(97, 98));
  assert.deepEqual([geometry.spacing, geometry.origin], [[1000, 2, 0.003], [4000, 5, 0.006]]);
  await assert.rejects(read(nrrd(...placed, 'space units: "mm" "mm" "parsec"')), /'parsec'/);
  for (const skip of ["line skip: 1", "lineskip: 1", "byte skip: -1", "byteskip: 1"]) {
    await assert.rejects(read(nrrd(skip)), new RegExp(skip.split(":")[0]), skip);
  }
});

test("a file that ends early or is another format is refused with the reason", async () => {
  await assert.rejects(read(nifti({ sform: true, little: true }).slice(0, 380)), /ends before its samples/);
  await assert.rejects(read(new TextEncoder().encode("not a volume")), /neither NRRD nor NIfTI/);
});
