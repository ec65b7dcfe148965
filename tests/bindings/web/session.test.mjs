// The JavaScript interface: results are those of the core, errors say what is wrong.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import test from "node:test";

const { joined, load } = await import(join(process.env.PALPATE_WEB, "palpate.js"));
const palpate = await load();

const distance = (a, b) => Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);

/** A hand that goes down onto the ball and circles on it [device mm]. */
function path(ticks) {
  return Array.from({ length: ticks }, (_, i) => {
    const angle = i / 400;
    return [3 * Math.sin(angle), 3 * Math.cos(angle) - 3, Math.max(8, 40 - 0.05 * i)];
  });
}

function ball(setup = {}) {
  const { volume, isovalue } = palpate.scene("sphere:48x48x48");
  return { volume, isovalue, session: palpate.session(volume, { isovalue, volume: "synthetic:sphere:48x48x48", ...setup }) };
}

test("a hand that presses on a ball leaves its proxy on the surface", () => {
  const { session } = ball();
  const ticks = session.replay(path(2000));
  assert.equal(ticks[0].constrained, false);
  const last = ticks.at(-1);
  assert.equal(last.constrained, true);
  assert.ok(Math.abs(last.density - last.isovalue) < 1e-6 * 255);
  assert.ok(distance(last.scp, last.hip) > 1);
  assert.ok(last.force[2] > 0.1 && Math.hypot(...last.force) <= 3.3 + 1e-12);
});

test("linear and smooth sessions have the same bits in the native program", { skip: !process.env.PALPATE }, () => {
  const folder = mkdtempSync(join(tmpdir(), "palpate-web-"));
  for (const field of ["linear", "cubic"]) {
    const { session } = ball({ field });
    session.stepAt(0, path(1)[0]);
    session.record();
    let drilled = 0;
    for (const [i, position] of path(2500).entries()) {
      if (i === 1500) session.command("friction", { static: 0.5, dynamic: 0.3 });
      session.stepAt(0.001 * (i + 1), position);
      if (i > 2000 && i % 50 === 0) drilled += session.drill(3, { sameStep: drilled > 0 });
    }
    assert.ok(drilled >= 2);
    assert.ok(session.undo());
    session.stepAt(3, path(1)[0]);
    const file = join(folder, `${field}.csv`);
    const text = session.recording();
    writeFileSync(file, text);
    const said = execFileSync(process.env.PALPATE, ["replay", file, "--validate"], { encoding: "utf8" });
    assert.match(said, /2501/);
    // Another sum of the events, and the native program refuses it.
    writeFileSync(file, text.replace(/\n0\.5,(-?\d)/, "\n0.5,1$1"));
    assert.throws(() => execFileSync(process.env.PALPATE, ["replay", file, "--validate"], { stdio: "pipe" }));
  }
});

test("drilling removes what is touched, and undo brings it back", () => {
  const { session, isovalue } = ball();
  session.replay(path(1500));
  const before = session.surface(isovalue);
  const deep = session.snapshot().scp;
  assert.ok(session.drill(4));
  session.stepAt(2, path(1500).at(-1));
  assert.ok(distance(session.snapshot().scp, deep) > 1, "the proxy follows into the hole");
  assert.equal(session.snapshot().version, 1);
  assert.notEqual(session.surface(isovalue).triangles.length, before.triangles.length);
  assert.ok(session.undo());
  assert.deepEqual(session.surface(isovalue).triangles, before.triangles);
  assert.ok(session.redo());
  assert.equal(session.redo(), false);
});

test("the parts of a surface are the whole, also if samples change in between", () => {
  for (const field of ["linear", "cubic"]) {
    const { session, isovalue } = ball({ field });
    session.replay(path(1500));
    const corners = ({ vertices, normals, triangles }) =>
      Array.from({ length: triangles.length / 3 }, (_, i) => {
        const places = [...triangles.subarray(3 * i, 3 * i + 3)].map((at) => [...vertices.subarray(3 * at, 3 * at + 3), ...normals.subarray(3 * at, 3 * at + 3)].join());
        return places.join(" ");
      }).sort();
    const whole = session.surface(isovalue);
    const parts = session.surfaceParts(isovalue, [7, 5, 9]);
    const first = parts.next().value;
    assert.ok(session.drill(4));
    assert.deepEqual(corners(joined([first, ...parts])), corners(whole));
    assert.ok(whole.triangles.length > 1000);
  }
});

test("input that is stale, lost or not a number gives no force", () => {
  const { session } = ball();
  const pressed = path(1500).at(-1);
  const force = () => Math.hypot(...session.snapshot().force);
  session.replay(path(1500));
  assert.ok(force() > 0.1);
  session.stepAt(1.501, pressed, { age: 0.05 });
  assert.equal(force(), 0, "stale");
  for (let i = 0; i < 1000; ++i) session.stepAt(1.502 + i / 1000, pressed);
  assert.ok(force() > 0.1);
  session.lose();
  session.stepAt(2.503);
  assert.equal(force(), 0, "lost");
  for (let i = 0; i < 1000; ++i) session.stepAt(2.504 + i / 1000, pressed);
  assert.ok(force() > 0.1);
  session.stepAt(3.504, [NaN, 0, 0]);
  assert.equal(force(), 0, "not a number");
});

test("a reading of now is fresh, whichever way the clocks were rounded", () => {
  const { session } = ball();
  const pressed = path(1500).at(-1);
  const force = () => Math.hypot(...session.snapshot().force);
  session.replay(path(1500));
  for (const [i, age] of [0, -1e-9, -0.004].entries()) {
    session.stepAt(1.501 + i / 1000, pressed, { age });
    assert.ok(force() > 0.1, `${age} s`);
  }
  session.stepAt(1.504, pressed, { age: -0.01 });
  assert.equal(force(), 0, "of the future");
});

test("a recording that could not begin does not prevent the next one", () => {
  const { session } = ball();
  session.stepAt(0, [0, 0, 40]);
  assert.throws(() => {
    for (;;) session.command("friction", { static: 0.5, dynamic: 0.3 });
  }, /too many commands/);
  assert.throws(() => session.record(), /too many commands/);
  session.stepAt(0.001);
  session.record();
  session.stepAt(0.002);
  assert.match(session.recording(), /# end \{/);
});

test("undo goes back to the version that it came from", () => {
  const { session } = ball();
  session.replay(path(1500));
  const version = (i) => {
    session.stepAt(1.5 + i / 1000, path(1500).at(-1));
    return session.snapshot().version;
  };
  assert.ok(session.drill(3));
  assert.equal(version(1), 1);
  session.edit({ fill: { low: [0, 0, 0], high: [4, 4, 4], value: 9 } });
  assert.equal(version(2), 2);
  session.undo();
  assert.equal(version(3), 1);
  session.undo();
  assert.equal(version(4), 0);
  session.redo();
  assert.equal(version(5), 1);
  session.undo();
  assert.ok(session.drill(2));
  assert.equal(version(6), 3);
});

test("samples of every type go in and come out", () => {
  for (const Type of [Uint8Array, Int16Array, Uint16Array, Float32Array]) {
    const samples = Type.from({ length: 60 }, (_, i) => i);
    const volume = palpate.volume(samples, { size: [3, 4, 5], spacing: [1, 2, 3] });
    assert.deepEqual(volume.samples(), samples);
    assert.deepEqual([volume.minimum, volume.maximum, volume.spacing], [0, 59, [1, 2, 3]]);
  }
});

test("errors are those of the core", () => {
  const { volume, session } = ball();
  for (const size of [[3, 4, 5], [NaN, 4, 5], [Infinity, 1, 1], [-3, -1, 1], [65536, 65536, 1]]) {
    assert.throws(() => palpate.volume(new Uint8Array(3), { size }), /three counts of at least 1/, String(size));
  }
  assert.throws(() => palpate.volume(new Uint8Array(0), { size: [65536, 65536, 1] }), /three counts/, "2^32 bytes are not none");
  assert.throws(() => palpate.scene("bagel"), /cylinder/);
  assert.throws(() => palpate.session(volume, {}), /'isovalue' is missing/);
  assert.throws(() => palpate.session(volume, { isovalue: 1, settings: { force: { stiffness: -1 } } }), /stiffness/);
  assert.throws(() => session.command("fly"), /no command 'fly'/);
  assert.throws(() => session.edit({ dig: {} }), Error);
});

test("the loop's statistics count late and missed ticks", async () => {
  const { session } = ball();
  session.read([0, 0, 40]);
  session.step();
  const due = session.due;
  while (performance.now() < due + 5);
  session.step();
  const report = session.report();
  assert.equal(report.ticks, 2);
  assert.ok(report.missed >= 4 && report.lateness.max >= 4e6, JSON.stringify(report));
});

/** A stand-in for Haply's Inverse Service behind a line, which answers each message with one, in a time of the test's. */
class Service {
  constructor() {
    this.now = 1000; // [ms]
    this.y = -0.25; // [m, service axes] away from the person
    Object.assign(this, { isOpen: true, error: "", waiting: [], forces: [], answers: true, closed: false, connects: 0 });
    this.greet();
  }
  greet() {
    const state = { cursor_position: this.place(), cursor_velocity: { x: 0, y: 0, z: 0 } };
    const config = { type: "inverse3", device_info: { major_version: 7, minor_version: 4, id: "049D" }, basis: { permutation: "XYZ" } };
    const status = { calibrated: true, in_use: false, power_supply: true, ready: true, started: true };
    this.waiting = [JSON.stringify({ session_id: 7, inverse3: [{ device_id: "049D", config, state, status }] })];
  }
  place() {
    return { x: -0.007, y: this.y, z: 0.13 };
  }
  connect() {
    ++this.connects;
    return this.isOpen;
  }
  send(message) {
    const { values } = JSON.parse(message).inverse3?.[0].commands.set_cursor_force ?? {};
    if (values) this.forces.push(values);
    if (this.answers) this.waiting.push(JSON.stringify({ inverse3: [{ device_id: "049D", state: { cursor_position: this.place() } }] }));
    return this.isOpen;
  }
  next() {
    return this.waiting.shift() ?? null;
  }
  close() {
    this.closed = true;
  }
  get newest() {
    return Math.hypot(...Object.values(this.forces.at(-1)));
  }
}

/** A session with that service in which the hand has come to press with more than 1 N. */
function pressed(t) {
  const service = new Service();
  t.mock.method(performance, "now", () => service.now);
  const { volume, isovalue } = palpate.scene("sphere:48x48x48");
  const device = "haply:host=127.0.0.1,port=10001";
  const force = { limit: 3, rate_limit: 2000, ramp: 0.05 };
  const session = palpate.session(volume, { isovalue, device, fit: true, settings: { force } }, service);
  t.after(() => session.core.isDeleted() || session.delete()); // a device serves one session
  const run = (ticks, { alive = true, moves = 0 } = {}) => {
    for (let i = 0; i < ticks; ++i) {
      service.now += 1;
      service.y += moves;
      if (alive) session.read([0, 0, 0]);
      session.step();
    }
  };
  for (let i = 0; i < 400 && !(service.forces.length > 0 && service.newest > 1); ++i) run(5, { moves: 0.0002 });
  run(100);
  assert.ok(service.newest > 1);
  return { service, session, run };
}
/** Ticks until no force arrives; at most `most`. */
const ticksToZero = ({ service, run }, how, most = 1000) => {
  let ticks = 0;
  while (service.newest > 0 && ++ticks < most) run(1, how);
  return ticks;
};

test("an Inverse3 touches over its service, by the native device's own code", (t) => {
  const { service, session, run } = pressed(t);
  const { y } = service.forces.at(-1);
  assert.ok(y < -0.99 * service.newest, "towards the person");
  assert.ok(session.snapshot().constrained);
  assert.ok(service.forces.every((force) => Math.hypot(...Object.values(force)) <= 3 + 1e-9));
  assert.match(session.report().device, /Inverse3 049D, firmware 7\.4/);
  assert.equal(session.report().problem, "");
  run(500, { moves: -0.0003 });
  assert.equal(service.newest, 0, "in the air");
});

test("a page without a sign of life, a hidden one and a silent service end the force in time", (t) => {
  const here = pressed(t);
  assert.ok(ticksToZero(here, { alive: false }) <= 82, "a page that is blocked, or draws no frames");
  here.run(600);
  assert.ok(here.service.newest > 1, "it comes back");
  here.session.lose();
  assert.ok(ticksToZero(here, { alive: false }) <= 3, "hidden");
  here.run(600);
  here.service.answers = false;
  const sent = here.service.forces.length;
  assert.ok(ticksToZero(here, {}) <= 30, "a service that says nothing");
  assert.ok(here.service.forces.length > sent, "it is told the zero");
});

test("a lost connection ends the force, and it begins with a ramp when the service is there again", (t) => {
  const { service, session, run } = pressed(t);
  service.isOpen = false;
  service.waiting = [];
  run(40);
  assert.match(session.report().problem, /lost the Inverse Service at 127\.0\.0\.1:10001/);
  assert.equal(Math.hypot(...session.snapshot().force), 0);
  service.isOpen = true;
  service.greet();
  const before = service.forces.length;
  run(1500);
  const again = service.forces.slice(before).map((force) => Math.hypot(...Object.values(force)));
  assert.equal(again[0], 0);
  assert.ok(service.newest > 1);
  again.forEach((force, i) => assert.ok(i === 0 || force - again[i - 1] < 0.5, "no step"));
});

test("the last message of a session is a zero", (t) => {
  const { service, session } = pressed(t);
  session.delete();
  assert.equal(service.newest, 0);
  assert.ok(service.closed);
});

test("a service without a device is an error that says so", (t) => {
  const service = new Service();
  service.waiting = [JSON.stringify({ session_id: 7, inverse3: [] })];
  const { volume, isovalue } = palpate.scene("sphere:48x48x48");
  assert.throws(() => palpate.session(volume, { isovalue, device: "haply:host=127.0.0.1,port=10001" }, service), /no Inverse3 attached/);
  assert.throws(() => palpate.session(volume, { isovalue, device: "haply:speed=3" }, new Service()), /speed/);
});

test("a 3D mouse moves the hand by its reports", (t) => {
  let now = 1000; // [ms]
  t.mock.method(performance, "now", () => now);
  const { volume, isovalue } = palpate.scene("sphere:48x48x48");
  const session = palpate.session(volume, { isovalue, device: "spacenav", settings: { transform: { scale: 0.5 } } });
  const run = (ticks) => {
    for (let i = 0; i < ticks; ++i) {
      now += 1;
      session.read([9, 9, 9]);
      session.step();
    }
  };
  run(10);
  assert.deepEqual(session.snapshot().hip, [0, 0, 0]);
  session.puck(1, Uint8Array.of(0, 0, 0xa2, 0xfe, 0, 0)); // -350: away
  run(500);
  const { hip } = session.snapshot();
  assert.ok(Math.abs(Math.hypot(...hip) - 25) < 0.2, String(hip));
  session.puck(1, new Uint8Array(6));
  run(100);
  assert.deepEqual(session.snapshot().hip, hip);
  assert.throws(() => ball().session.puck(1, new Uint8Array(6)), /no 3D mouse/);
});

test("the settings are those of the table, and change the feel by name", () => {
  const { session } = ball({ settings: { force: { stiffness: 0.2, rate_limit: "inf", start_below: "inf" } } });
  const value = (name) => session.settings().find((one) => one.name === name)?.value;
  assert.ok(session.settings().length > 20);
  const { unit, about, least, most } = session.settings().find(({ name }) => name === "force.limit");
  assert.deepEqual([unit, about, least, most], ["N", "Largest force, within the device's limit", 0, Number.MAX_VALUE]);
  assert.equal(value("force.rate_limit"), Infinity);
  assert.equal(value("force.stiffness"), 0.2);

  session.replay(path(1500));
  const force = () => Math.hypot(...session.snapshot().force);
  const soft = force();
  session.set("force.stiffness", 0.4);
  for (let i = 0; i < 1000; ++i) session.stepAt(1.501 + i / 1000, path(1500).at(-1));
  assert.ok(Math.abs(force() - 2 * soft) < 1e-6, `${soft} ${force()}`);
  session.set("friction.static_coefficient", 0.5);
  assert.equal(value("friction.static_coefficient"), 0.5);
  session.set("force.rate_limit", Infinity);

  assert.throws(() => session.set("force.stiffness", -1), /stiffness/);
  assert.throws(() => session.set("force.stifness", 1), /did you mean force\.stiffness/);
  assert.equal(value("force.stiffness"), 0.4);
});

test("a simulated hand touches by itself, with the same bits each time", () => {
  const run = () => {
    const { session } = ball({ device: "simulated:hand=hold,depth=6", fit: true });
    const ticks = [];
    for (let i = 0; i < 2000; ++i) {
      session.stepAt(i / 1000);
      ticks.push(session.snapshot());
    }
    assert.match(session.report().device, /simulated .*, normal grip/);
    return ticks;
  };
  const ticks = run();
  assert.equal(ticks[0].constrained, false);
  assert.ok(ticks.at(-1).constrained);
  assert.ok(Math.hypot(...ticks.at(-1).force) > 0.2);
  assert.deepEqual(run(), ticks);
  assert.throws(() => ball({ device: "simulated:hand=waves" }), /waves/);
  assert.throws(() => ball({ device: "simulated:file=a.csv" }), /a page has no files/);
});
