// Palpate for the browser and for Node: volumes, and sessions that feel them. Types: palpate.d.ts.
import { inflated } from "./inflated.js";
import createCore from "./palpate_core.js";

const snapshotNames = [
  "number", "time", "hip", "scp", "force", "normal", "constrained", "density", "isovalue", "flags",
  "touched", "inside", "version", "missed", "stiffness", "status",
];
const vectors = new Set(["hip", "scp", "force", "normal"]);

const sampleTypes = new Map([
  [Uint8Array, "uint8"], [Uint8ClampedArray, "uint8"], [Int16Array, "int16"], [Uint16Array, "uint16"],
  [Float32Array, "float32"],
]);
const arrayTypes = { uint8: Uint8Array, int16: Int16Array, uint16: Uint16Array, float32: Float32Array };

/** The module's bytes, from beside this file: emscripten's own loader cannot read files in Node, and unpacks nothing. */
async function readCore() {
  const address = new URL("./palpate_core.wasm.gz", import.meta.url);
  if (address.protocol !== "file:") {
    const answer = await fetch(address);
    if (!answer.ok) throw new Error(`${address}: ${answer.status} ${answer.statusText}`);
    return unpacked(await answer.arrayBuffer());
  }
  const { readFile } = await import("node:fs/promises");
  return unpacked(await readFile(address));
}

/** Some servers let the browser unpack what is named .gz. */
async function unpacked(bytes) {
  const stream = new Blob([bytes]).stream();
  const isPacked = new DataView(await new Blob([bytes]).slice(0, 2).arrayBuffer()).getUint16(0) === 0x1f8b;
  return new Response(isPacked ? stream.pipeThrough(new DecompressionStream("gzip")) : stream).arrayBuffer();
}

/** Samples of a grid. */
export class Volume {
  constructor(core) {
    this.core = core;
    const { samples, ...geometry } = core.description();
    Object.assign(this, geometry);
  }
  /** A copy of the samples, x fastest. */
  samples() {
    const bytes = this.core.description().samples.slice();
    return new arrayTypes[this.type](bytes.buffer);
  }
  delete() {
    this.core.delete();
  }
}

/** A hand that feels a volume: the native servo, one step() per tick. */
export class Session {
  constructor(core) {
    this.core = core;
  }
  read(position, { buttons = 0, measured = performance.now() } = {}) {
    this.core.read(position[0], position[1], position[2], buttons, measured / 1000);
  }
  lose() {
    this.core.lose();
  }
  puck(number, bytes) {
    this.core.puck(number, bytes);
  }
  step() {
    return this.core.step();
  }
  stepAt(time, position, { buttons = 0, age = 0 } = {}) {
    if (position) this.core.read(position[0], position[1], position[2], buttons, time - age);
    return this.core.stepAt(time);
  }
  get due() {
    return 1000 * this.core.due();
  }
  stop() {
    this.core.stop();
  }
  command(name, members = {}) {
    this.core.send(JSON.stringify({ [name]: members }));
  }
  settings() {
    const number = (value) => (typeof value === "string" ? Number(value.replace("inf", "Infinity")) : value);
    return JSON.parse(this.core.settings()).map((one) => ({ ...one, least: number(one.least), most: number(one.most), value: number(one.value) }));
  }
  set(name, value) {
    this.core.set(name, value);
  }
  edit(edit, { sameStep = false } = {}) {
    this.core.edit(JSON.stringify(edit), sameStep);
  }
  drill(radius, { sameStep = false } = {}) {
    return this.core.drill(radius, sameStep);
  }
  undo() {
    return this.core.undo();
  }
  redo() {
    return this.core.redo();
  }
  snapshot() {
    const numbers = this.core.snapshot();
    const result = {};
    let at = 0;
    for (const name of snapshotNames) {
      if (vectors.has(name)) {
        result[name] = [numbers[at], numbers[at + 1], numbers[at + 2]];
        at += 3;
      } else {
        result[name] = numbers[at++];
      }
    }
    result.constrained = result.constrained === 1;
    return result;
  }
  report() {
    return JSON.parse(this.core.report());
  }
  record(begun = new Date()) {
    this.core.record(begun.toISOString());
  }
  recording() {
    return this.core.recording();
  }
  surface(isovalue) {
    const surface = this.core.surface(isovalue);
    try {
      return surface.whole();
    } finally {
      surface.delete();
    }
  }
  /** The same in parts, box by box, of the samples as they are when the first part is taken. */
  *surfaceParts(isovalue, cells = [4, 4, 4]) {
    const surface = this.core.surface(isovalue);
    try {
      for (let part = surface.next(...cells); part; part = surface.next(...cells)) yield part;
    } finally {
      surface.delete();
    }
  }
  /** Renders a hand's path [device mm], one position per tick at `rate` [Hz]. */
  replay(path, rate = 1000) {
    return path.map((position, i) => {
      this.stepAt(i / rate, position);
      return this.snapshot();
    });
  }
  delete() {
    this.core.delete();
  }
}

/** One mesh of several; vertices on their borders occur once in each. */
export function joined(parts) {
  const sum = (name) => parts.reduce((total, part) => total + part[name].length, 0);
  const result = {
    vertices: new Float32Array(sum("vertices")), normals: new Float32Array(sum("normals")), triangles: new Uint32Array(sum("triangles")),
  };
  let [vertices, triangles] = [0, 0];
  for (const part of parts) {
    result.vertices.set(part.vertices, vertices);
    if (part.normals.length > 0) result.normals.set(part.normals, vertices);
    for (const corner of part.triangles) result.triangles[triangles++] = corner + vertices / 3;
    vertices += part.vertices.length;
  }
  return result;
}

/** Of gzip or zlib, with their checksums. */
function unpackedPart(bytes, name) {
  return inflated(bytes, bytes[0] === 0x1f ? "gzip" : "deflate").catch(({ message }) => {
    throw new Error(`${name}: ${message}`);
  });
}

class Palpate {
  constructor(core, module) {
    Object.assign(this, { core, module });
  }
  /** The core reads files in one go, or says what has to be unpacked before. */
  async read(files, path = files[0].path) {
    const all = new Map(files.map(({ path: at, bytes }) => [at, bytes]));
    for (;;) {
      this.core.givenFiles.all = all;
      const { packed, volume, ...about } = this.core.read(path);
      if (!packed) return { volume: new Volume(volume), ...about };
      const bytes = all.get(packed.file).subarray(packed.offset, packed.offset + packed.length);
      all.set(packed.unpacked, await unpackedPart(bytes, packed.file));
    }
  }
  volume(samples, { size, spacing = [1, 1, 1], origin = [0, 0, 0], direction = [1, 0, 0, 0, 1, 0, 0, 0, 1] }) {
    const type = sampleTypes.get(samples.constructor);
    if (!type) throw new Error("samples are a Uint8Array, Int16Array, Uint16Array or Float32Array");
    const bytes = new Uint8Array(samples.buffer, samples.byteOffset, samples.byteLength);
    return new Volume(this.core.newVolume(bytes, type, size, spacing, origin, direction));
  }
  scene(specification) {
    const { volume, ...rest } = this.core.scene(specification);
    return { volume: new Volume(volume), ...rest };
  }
  session(volume, setup, line = null) {
    return new Session(this.core.newSession(volume.core, JSON.stringify(setup), line));
  }
}

/** Loads the module; `wasm` are its bytes, if they are not beside this file, or the `module` of another Palpate. */
export async function load(wasm) {
  const module = wasm instanceof WebAssembly.Module ? wasm : await WebAssembly.compile(wasm ?? (await readCore()));
  const core = await new Promise((done, fail) => {
    const instantiateWasm = (imports, use) => {
      WebAssembly.instantiate(module, imports).then(use).catch(fail);
      return {};
    };
    createCore({ instantiateWasm }).then(done, fail);
  });
  return new Palpate(core, module);
}
