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

/** 2 x 3 x 4 samples 0, 1, ... of int16, spacing 1, 2, 3, with an sform or a qform. */
function nifti({ sform, little, slope = 0 }) {
  const view = new DataView(new ArrayBuffer(352 + 48));
  view.setInt32(0, 348, little);
  [3, 2, 3, 4].forEach((n, i) => view.setInt16(40 + 2 * i, n, little));
  view.setInt16(70, 4, little);
  [1, 1, 2, 3].forEach((x, i) => view.setFloat32(76 + 4 * i, x, little));
  view.setFloat32(108, 352, little);
  view.setFloat32(112, slope, little);
  view.setInt16(sform ? 254 : 252, 1, little);
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
  const { samples } = await read(nifti({ sform: true, little: true, slope: 2 }));
  assert.deepEqual(samples.slice(0, 3), Float32Array.of(0, 2, 4));
});

test("a file that ends early or is another format is refused with the reason", async () => {
  await assert.rejects(read(nifti({ sform: true, little: true }).slice(0, 380)), /ends before its samples/);
  await assert.rejects(read(new TextEncoder().encode("not a volume")), /neither NRRD nor NIfTI/);
});
