// The worker's loop, in Node's own thread: an error ends the session, and the next one begins.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { cpSync, mkdtempSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import test from "node:test";

const channels = [];
globalThis.MessageChannel = class extends MessageChannel {
  constructor() {
    super();
    channels.push(this);
  }
};
globalThis.onmessage = null;
let heard = [];
globalThis.postMessage = (message) => heard.push(message);
await import(join(process.env.PALPATE_WEB, "worker.js"));

const send = (name, argument = null) => globalThis.onmessage({ data: { [name]: argument } });
const setup = { settings: { force: { stale_after: 0.08 } } };
const begin = (more = {}) => send("begin", { scene: "sphere:48x48x48", setup, ...more });
const messages = (name) => heard.filter((message) => name in message).map((message) => message[name]);

/** Moves the hand down onto the ball until `done`. */
async function press(done) {
  for (let z = 30; !done(); z = Math.max(12, z - 0.3)) {
    send("read", { position: [0, 0, z], buttons: 0, at: performance.timeOrigin + performance.now() });
    await new Promise((resolve) => setTimeout(resolve, 5));
  }
}
const touches = () => messages("snapshot").some((now) => now.constrained);

test.afterEach(() => (heard = []));
test.after(() => {
  send("end");
  for (const { port1 } of channels) port1.close();
});

test("a session that cannot begin leaves the one before it", { timeout: 300000 }, async () => {
  await begin({ scene: "bagel" });
  assert.match(messages("error")[0], /cylinder/);
  await begin();
  assert.equal(messages("ready").length, 1);
  await press(touches);

  heard = [];
  await begin({ setup: { settings: { force: { stiffness: -1 } } } });
  assert.match(messages("error")[0], /stiffness/);
  assert.equal(messages("ready").length, 0);
  await press(touches);

  heard = [];
  await begin();
  assert.equal(messages("ready").length, 1);
  await press(touches);
  assert.deepEqual(messages("error"), []);
});

test("an error in the loop ends its session without force and is told, and the next session begins", { timeout: 300000 }, async () => {
  await begin();
  send("record");
  await press(() => messages("snapshot").some(({ force }) => Math.hypot(...force) > 0.1));
  send("burr", Infinity);
  await press(() => messages("error").length > 0);
  assert.deepEqual(messages("error").map((text) => /^the session has ended, and there is no force any more: .*radius/.test(text)), [true]);
  const { force, constrained } = messages("snapshot").at(-1);
  assert.deepEqual({ force, constrained }, { force: [0, 0, 0], constrained: false });
  assert.match(messages("recording")[0], /# end \{/);
  heard = [];
  send("undo"); // of no session
  send("recording");
  assert.deepEqual(heard, []);

  await begin();
  await press(touches);
  assert.deepEqual(messages("error"), []);
});

test("ticks go on while a surface is made, and a new session drops it", { timeout: 300000 }, async () => {
  await begin();
  await press(touches);
  heard = [];
  send("report");
  send("surface", 0);
  while (!messages("surface").some(({ last }) => last)) await new Promise((resolve) => setTimeout(resolve, 5));
  send("report");
  const [before, after] = messages("report");
  assert.ok(after.ticks > before.ticks);
  const corners = messages("surface").reduce((sum, { triangles }) => sum + triangles.length, 0);

  send("surface", 0);
  await begin();
  heard = [];
  send("surface", 0);
  while (!messages("surface").some(({ last }) => last)) await new Promise((resolve) => setTimeout(resolve, 5));
  assert.equal(messages("surface").reduce((sum, { triangles }) => sum + triangles.length, 0), corners, "of one surface");
});

test("a setting that is refused is told, and the settings in use come back", { timeout: 300000 }, async () => {
  await begin({ about: { name: "ball" } });
  const [{ settings, about }] = messages("ready");
  assert.deepEqual(about, { name: "ball" });
  const stiffness = (all) => all.find(({ name }) => name === "force.stiffness").value;
  const value = stiffness(settings) / 2;
  await send("set", ["force.stiffness", value]);
  await send("set", ["force.stiffness", -1]);
  assert.deepEqual(messages("settings").map(stiffness), [value, value]);
  assert.match(messages("error")[0], /^stiffness .* = -1: must be/);
});

test("a module that cannot be loaded is told before anything is asked for", () => {
  const bare = mkdtempSync(join(tmpdir(), "palpate-web-"));
  cpSync(process.env.PALPATE_WEB, bare, { recursive: true, filter: (path) => !path.endsWith(".wasm.gz") });
  const program = `globalThis.onmessage = null;
  globalThis.postMessage = (message) => {
    console.log(JSON.stringify(message));
    process.exit();
  };
  await import(${JSON.stringify(join(bare, "worker.js"))});`;
  const { stdout } = spawnSync(process.execPath, ["--input-type=module", "--eval", program], { encoding: "utf8", timeout: 60000 });
  assert.match(stdout, /^\{"error":".*palpate_core\.wasm\.gz/);
});
