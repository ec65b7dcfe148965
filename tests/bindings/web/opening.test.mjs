// Volumes that other programs have written are opened: DICOM and Zarr as the native program reads them.
import assert from "node:assert/strict";
import { execFileSync, spawnSync } from "node:child_process";
import { existsSync, mkdtempSync, readFileSync, readdirSync, statSync } from "node:fs";
import { createServer } from "node:http";
import { tmpdir } from "node:os";
import { join, relative } from "node:path";
import test from "node:test";

const page = join(process.env.PALPATE_WEB, "page");
const { lastAsked, readAddress: openAddress, readFiles: openFiles } = await import(join(page, "open.js"));
const { load } = await import(join(process.env.PALPATE_WEB, "palpate.js"));
const { module } = await load();
const readFiles = (files) => openFiles(files, () => load(module));
const readAddress = (address) => openAddress(address, () => load(module));
globalThis.location = { href: "http://localhost/" };

const folder = mkdtempSync(join(tmpdir(), "palpate-web-"));
execFileSync("/usr/bin/python3", ["-B", join(process.env.PALPATE_SOURCE, "tests/bindings/web/make_volumes.py"), folder], { stdio: "inherit" });
const zstdIsThere = existsSync(join(page, "fzstd.js"));

/** A file or a folder as it is dropped. */
function dropped(name) {
  const all = (path) => (statSync(path).isDirectory() ? readdirSync(path).flatMap((one) => all(join(path, one))) : [path]);
  return all(join(folder, name)).map((path) => ({ path: relative(folder, path), file: new Blob([readFileSync(path)]) }));
}
const open = (name) => readFiles(dropped(name));
const raw = (name) => {
  const bytes = readFileSync(join(folder, `${name}.raw`));
  return new Float32Array(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length));
};

const sameVolume = (one, other, name = "") => {
  assert.equal(one.samples.constructor.name, other.samples.constructor.name, name);
  assert.deepEqual(one.samples, other.samples, name);
  assert.deepEqual(one.geometry.size, other.geometry.size, name);
  for (const part of ["spacing", "origin", "direction"]) {
    one.geometry[part].forEach((x, i) => assert.ok(Math.abs(x - other.geometry[part][i]) < 1e-6, `${name} ${part}: ${one.geometry[part]} is not ${other.geometry[part]}`));
  }
};

test("DICOM series in every order of bytes and frames of one file are one volume in Hounsfield units", async () => {
  const series = await open("implicit");
  assert.deepEqual(series.geometry, { size: [6, 5, 4], spacing: [3, 2, 4], origin: [-10, 20, 30], direction: [1, 0, 0, 0, 0, 1, 0, -1, 0] });
  assert.deepEqual(series.samples, Int16Array.from({ length: 120 }, (_, i) => ((i * 7) % 251) - 100));
  assert.deepEqual(series.marks, { skin: -300, bone: 250 });
  assert.equal(series.name, "implicit");
  for (const other of ["big", "frames.dcm"]) sameVolume(await open(other), series);
  assert.deepEqual((await Promise.all(["empty", "units", "shared"].map(open))).map(({ marks }) => marks?.bone), [undefined, undefined, 250]);
  const halves = await open("explicit");
  assert.deepEqual(halves.samples, Float32Array.from({ length: 120 }, (_, i) => 0.5 * ((i * 7) % 251) - 100));
});

test("DICOM with a missing slice, compressed pixels or none is refused with the reason", async () => {
  await assert.rejects(open("incomplete"), /not evenly spaced/);
  await assert.rejects(open("compressed.dcm"), /1\.2\.840\.10008\.1\.2\.4\.70 is not read in the browser: convert/);
  await assert.rejects(readFiles([...dropped("implicit/notes.txt"), ...dropped("none.zarr").slice(-1)]), /none of these files is NRRD, MetaImage, NIfTI, or DICOM with pixels: convert/);
  const [{ path, file }] = dropped("implicit");
  const bytes = await file.arrayBuffer();
  for (let end = 132; end < bytes.byteLength; end += 1) {
    await assert.rejects(readFiles([{ path, file: new Blob([bytes.slice(0, end)]) }]), Error, `${end} bytes`);
  }
});

for (const name of ["none", "zlib", "gzip", "lz4", "zstd", "blosc_lz4", "blosc_zlib", "blosc_zstd", "big_endian"]) {
  const skip = name.includes("zstd") && !zstdIsThere && "fzstd was not installed (scripts/deep/web)";
  test(`OME-Zarr of chunks in ${name} has the samples and the geometry of its metadata`, { skip }, async () => {
    const { samples, geometry } = await open(`${name}.zarr`);
    assert.deepEqual(Float32Array.from(samples), raw(name));
    assert.deepEqual([geometry.spacing, geometry.origin], [[1, 2, 3], [10, 20, 30]]);
  });
}

test("a Zarr 3 array in shards is read, and missing chunks have the fill value", async () => {
  const { samples, geometry } = await open("sharded.zarr");
  assert.deepEqual(Float32Array.from(samples), raw("sharded"));
  assert.deepEqual(geometry.size, [6, 5, 4]);
});

test("of levels, the finest one that is not too large is read, at its place", async () => {
  const { samples, geometry } = await open("large.zarr");
  assert.deepEqual(samples, Int16Array.from({ length: 8 }, (_, i) => i));
  assert.deepEqual([geometry.size, geometry.spacing, geometry.origin], [[2, 2, 2], [12288, 8192, 2], [6142.5, 4095, 0.5]]);
});

test("Zarr that the page does not read is refused with the reason", async () => {
  await assert.rejects(open("blosclz.zarr"), /blosc with blosclz/);
  await assert.rejects(readFiles([{ path: "x/zarr.json", file: new Blob(["{}"]) }]), /no Zarr array and no OME-Zarr/);
});

/** The address of a server of the folder, which answers `otherwise` for what matches `exempt`. */
async function served(t, exempt = /^$/, otherwise = 404) {
  const server = createServer((request, answer) => {
    const file = join(folder, decodeURIComponent(new URL(request.url, "http://localhost").pathname));
    if (exempt.test(request.url)) return answer.writeHead(otherwise).end();
    if (!existsSync(file) || !statSync(file).isFile()) return answer.writeHead(404).end();
    answer.end(readFileSync(file));
  });
  await new Promise((listens) => server.listen(0, "127.0.0.1", listens));
  t.after(() => server.close());
  return `http://127.0.0.1:${server.address().port}`;
}

test("a Zarr and files are opened by their address", async (t) => {
  const at = await served(t);
  for (const end of ["", "/", "/.zattrs"]) sameVolume(await readAddress(`${at}/gzip.zarr${end}`), await open("gzip.zarr"));
  sameVolume(await readAddress(`${at}/frames.dcm`), await open("frames.dcm"));
  await assert.rejects(readAddress(`${at}/nothing.nrrd`), /there is no such file/);
  await assert.rejects(readAddress(`${at}/nothing.tif`), /no Zarr array.* or a file named \.nrrd/);
});

test("a forbidden chunk is no empty one, forbidden metadata are no metadata, and errors show no secrets", async (t) => {
  const chunks = await served(t, /\/c\//, 403);
  await assert.rejects(readAddress(`${chunks}/image.zarr?signature=abc`), ({ message }) => / 403 /.test(message) && !message.includes("abc"));
  const metadata = await served(t, /zarr\.json/, 403);
  sameVolume(await readAddress(`${metadata}/gzip.zarr`), await open("gzip.zarr"));
  await assert.rejects(readAddress("https://me:secret@localhost/a.zarr"), ({ message }) => /user or password/.test(message) && !message.includes("secret"));
});

test("what was chosen and assumed is told", async () => {
  const notes = async (name) => (await open(name)).notes.join("; ");
  assert.match(await notes("none.zarr"), /of 2 channels, 0 was taken/);
  assert.match(await notes("unspaced"), /no pixel spacing: 1 mm .* no distance between slices: 1 mm .* series/);
  assert.match(await notes("implicit"), /notes\.txt is no DICOM and was passed over/);
  assert.match(await notes("no_slope"), /RescaleSlope is 0/);
  assert.match(await notes("lacking"), /1 of its 4 slices give no slope or no intercept/);
  assert.match(await notes("holes.nrrd"), /became the least/);
  assert.match(await notes("no_unit.zarr"), /mm were taken/);
  assert.match(await notes("packed.zarr"), /scale_factor .* add_offset .* not applied/);
  assert.match(await notes("coarse_first.zarr"), /were sorted/);
  assert.match(await notes("large.zarr"), /of 2 levels, 1 was taken/);
  const oriented = await Promise.all(["implicit", "unplaced", "ras.nrrd", "sform.nii", "turned.zarr"].map(open));
  const turnedNowhere = await Promise.all(["plain.nrrd", "plain.nii", "image.zarr"].map(open));
  assert.deepEqual([oriented.map((v) => v.oriented), turnedNowhere.map((v) => v.oriented)], [[true, true, true, true, true], [false, false, false]]);
});

test("a folder with one volume opens it, whatever systems leave beside it", async () => sameVolume(await open("left"), await open("plain.nii")));

/** The service worker over a network and a cache: what it answers for a file, and what it has stored by then. */
async function visited(path, network, { put = () => {}, cached = "cached" } = {}) {
  const [handlers, stored, kept] = [{}, [], []];
  const caches = {
    open: async () => ({
      put: async (file, fresh) => {
        put(file);
        stored.push([new URL(file).pathname, await fresh.text()]);
      },
      match: async () => cached && new Response(cached),
    }),
  };
  new Function("addEventListener", "registration", "caches", "clients", "skipWaiting", "fetch", readFileSync(join(process.env.PALPATE_WEB, "offline.js"), "utf8"))(
    (name, handler) => (handlers[name] = handler), { scope: "http://x/" }, caches, { claim() {} }, () => {}, async () => network(),
  );
  let found = null;
  handlers.fetch({ request: { url: `http://x${path}`, method: "GET" }, respondWith: (answer) => (found = answer), waitUntil: (work) => kept.push(work) });
  const answer = await found;
  await Promise.all(kept);
  const install = () => new Promise((done, fail) => handlers.install({ waitUntil: (work) => work.then(done, fail) }));
  return { answer, stored, install };
}

test("the service worker stores what is the page's alone, and falls back to it", async () => {
  const script = (body, more) => () => new Response(body, { headers: { "Content-Type": "text/javascript" }, ...more });
  const visit = async (...given) => {
    const { answer, stored } = await visited("/page/page.js", ...given);
    return [answer.status, answer.status && (await answer.text()), stored.map(([, text]) => text)];
  };
  assert.deepEqual(await visit(script("new")), [200, "new", ["new"]]);
  assert.deepEqual(await visit(script("busy", { status: 503 })), [200, "cached", []]);
  assert.deepEqual(await visit(script("gone", { status: 404 })), [404, "gone", []]);
  assert.deepEqual(await visit(() => new Response("<html>log in", { headers: { "Content-Type": "text/html" } })), [200, "cached", []]);
  assert.deepEqual(await visit(() => Object.defineProperty(script("moved")(), "redirected", { value: true })), [200, "moved", []]);
  assert.deepEqual(await visit(() => Promise.reject(new Error("no network"))), [200, "cached", []]);
  assert.deepEqual(await visit(script("new"), { put: () => { throw new Error("no room"); } }), [200, "new", []]);
  assert.deepEqual(await visit(() => new Response(null, { status: 304 })), [304, "", []]);
  const redirect = { status: 0, type: "opaqueredirect" };
  assert.equal((await visited("/page/", () => redirect)).answer, redirect);
  const login = await visited("/page/page.js", () => new Response("<html>log in", { headers: { "Content-Type": "text/html" } }));
  await assert.rejects(login.install(), /not what was expected/);
});

/** The same places and values, with the axes of the grid in another order and some against their direction. */
function regridded({ size, direction, samples }, order, flips) {
  const stride = [1, size[0], size[0] * size[1]];
  const shape = order.map((axis) => size[axis]);
  const values = Float32Array.from({ length: samples.length }, (_, i) => {
    const at = [i % shape[0], Math.floor(i / shape[0]) % shape[1], Math.floor(i / shape[0] / shape[1])];
    return samples[order.reduce((sum, axis, a) => sum + (flips[a] ? shape[a] - 1 - at[a] : at[a]) * stride[axis], 0)];
  });
  const turned = [0, 1, 2].flatMap((row) => order.map((axis, a) => direction[3 * row + axis] * (flips[a] ? -1 : 1)));
  return { size: shape, direction: turned, samples: values, oriented: true };
}

test("slices are drawn by directions: any order and direction of the grid's axes shows the same picture", async () => {
  const { sliceOf, viewsOf } = await import(join(page, "charts.js"));
  const plain = { size: [3, 4, 5], direction: [1, 0, 0, 0, 1, 0, 0, 0, 1], samples: Float32Array.from({ length: 60 }, (_, i) => i), oriented: true };
  const [axial, coronal, sagittal] = viewsOf(plain);
  assert.deepEqual([axial, coronal, sagittal].map(({ letters }) => letters.join("")), ["RLAP", "RLSI", "APSI"]);
  assert.deepEqual(viewsOf({ ...plain, oriented: false }).map(({ letters }) => letters.join("")), ["xy", "xz", "yz"]);
  assert.equal(sliceOf(plain, axial, [0, 0, 0])[0], 0); // right and front are at the upper left
  assert.equal(sliceOf(plain, coronal, [0, 0, 0])[0], 48); // right and head
  for (const order of [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]]) {
    for (let bits = 0; bits < 8; ++bits) {
      const flips = [1, 2, 4].map((bit) => (bits & bit) !== 0);
      const other = regridded(plain, order, flips);
      const at = order.map((axis, a) => (flips[a] ? other.size[a] - 2 : 1));
      viewsOf(other).forEach((view, i) => {
        assert.deepEqual(sliceOf(other, view, at), sliceOf(plain, [axial, coronal, sagittal][i], [1, 1, 1]), `${order} ${flips} ${i}`);
        assert.deepEqual(view.letters, [axial, coronal, sagittal][i].letters);
      });
    }
  }
});

const cases = JSON.parse(readFileSync(join(folder, "cases.json")));
const isReadable = (name) => zstdIsThere || !name.startsWith("zstd");

test("what the page would read otherwise than the native program is refused with the reason", async () => {
  for (const [name, word] of Object.entries(cases.refused).filter(([one]) => isReadable(one))) {
    await assert.rejects(open(name), ({ message }) => {
      assert.ok(message.includes(word) && /: (convert|copy|save|correct|choose|give)/.test(message), `${name}: ${message}`);
      return true;
    }, name);
  }
});

/** What the native program reads, as the page opens it, or why it does not. */
function native(name) {
  const result = spawnSync(process.env.PALPATE, ["convert", join(folder, name), join(folder, "native.nrrd")], { encoding: "utf8" });
  return result.status === 0 ? { volume: open("native.nrrd") } : { refused: result.stderr };
}

test("the native program reads and writes the same", { skip: !process.env.PALPATE }, async () => {
  for (const from of ["implicit", "explicit", "frames.dcm", "blosc_lz4.zarr", ...cases.same.filter(isReadable)]) {
    sameVolume(await open(from), await native(from).volume, from);
  }
  if (!zstdIsThere) return;
  execFileSync(process.env.PALPATE, ["convert", join(folder, "blosc_lz4.zarr"), join(folder, "native.zarr")]); // OME-Zarr 0.5, zstd
  sameVolume(await open("native.zarr"), await open("blosc_lz4.zarr"));
});

test("NRRD, MetaImage and NIfTI are read, or refused in the same words, as by the native program", { skip: !process.env.PALPATE }, async () => {
  const counts = { read: 0, refused: 0 };
  for (const name of cases.files) {
    const { volume, refused } = native(name);
    const opened = open(name.split("/")[0]);
    if (refused) {
      await assert.rejects(opened, ({ message }) => {
        assert.ok(refused.includes(message.slice(message.indexOf(": ") + 2)), `${name}: ${message}, not ${refused}`);
        return true;
      }, name);
    } else {
      sameVolume(await opened, await volume, name);
    }
    counts[refused ? "refused" : "read"] += 1;
  }
  assert.ok(counts.read > 20 && counts.refused >= 15, JSON.stringify(counts));
});

test("of several that are read at the same time, the last one that was asked for is used", async () => {
  const used = [];
  const ask = lastAsked((data) => used.push(data), (error) => used.push(error.message));
  const slow = {};
  const read = (name) => () => new Promise((done, fail) => (slow[name] = { done: () => done(name), fail: () => fail(new Error(name)) }));
  const all = ["a", "b", "c"].map((name) => ask(read(name)));
  slow.c.done();
  slow.a.done();
  slow.b.fail();
  await Promise.all(all);
  assert.deepEqual(used, ["c"]);

  const again = [ask(read("d")), ask(read("e"))];
  slow.e.fail();
  slow.d.done();
  await Promise.all(again);
  assert.deepEqual(used, ["c", "e"]);
});
