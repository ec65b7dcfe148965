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
