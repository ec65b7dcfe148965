// The servo loop of a page, in a Worker: sleeps until each tick is due and posts snapshots. Messages are
// { name: argument }, see Hand in hand.js. The surface that is drawn is made box by box, in the time that ticks leave. A session that has lost its page has stale input and no force.
import { endedBy, withoutForce } from "./hand.js";
import { Line } from "./line.js";
import { joined, load } from "./palpate.js";

const betweenSnapshots = 16; // [ms]
const betweenCarvings = 40; // [ms]
const boxTime = 0.3; // [ms] that a box of a surface takes at most on an idle machine
const wakeEarly = 0.1; // [ms] before a tick, to take messages
const partsAtOnce = 64; // boxes with triangles in a message
const sleeper = globalThis.crossOriginIsolated ? new Int32Array(new SharedArrayBuffer(4)) : null;
const turns = new MessageChannel();

const loaded = load();
loaded.then(({ module }) => post("module", module), ({ message }) => post("error", message)); // the page reads files with it
let session;
let line = null; // to the session's device
let newest = null; // snapshot
let running = false;
let turning = false; // a message to turn() is under way
let lastSnapshot = 0;
let lastCarving = 0;
let burr = 0; // [mm] radius, 0: none
let carving = false; // within one step of undo
let recording = false;
let lastBegin = Promise.resolve();
let meshing = null; // a surface under way: { parts, made }

const post = (name, value, transfer = []) => postMessage({ [name]: value }, transfer);

/** One tick, then back to the event loop, which takes the messages that have come meanwhile. */
function turn() {
  turning = running;
  if (!running) return;
  try {
    tick();
    turns.port2.postMessage(null);
  } catch (error) {
    turning = false;
    end(error);
  }
}

/** After an error in the loop: the device gets its zero, or loses its connection. */
function end(error) {
  try {
    if (recording) post("recording", session.recording());
    endSession();
  } catch {
    line?.close();
    session = null;
  }
  running = false;
  if (newest) post("snapshot", withoutForce(newest));
  post("error", endedBy(error.message, "Open a volume to begin again"));
}

function tick() {
  if (meshing) mesh();
  const left = session.due - performance.now();
  if (left > wakeEarly) {
    // Without isolation there is no sleep of under 4 ms: the loop keeps its processor busy.
    if (sleeper) Atomics.wait(sleeper, 0, 0, left - wakeEarly);
    return; // messages that have come meanwhile belong to the next tick
  }
  while (session.due > performance.now());
  running = session.step();
  const now = performance.now();
  if (burr > 0 && now - lastCarving > betweenCarvings) carve(now);
  if (now - lastSnapshot > betweenSnapshots || !running) {
    lastSnapshot = now;
    newest = session.snapshot();
    post("snapshot", newest);
  }
}

/** Boxes of the surface until the next tick is near, and for a moment if it is late already. */
function mesh() {
  const until = Math.max(session.due - boxTime, performance.now() + boxTime);
  while (meshing && performance.now() < until) meshBox();
}

function meshBox() {
  const { value, done } = meshing.parts.next();
  const { made } = meshing;
  if (value?.triangles.length > 0) made.push(value);
  if (!done && made.length < partsAtOnce) return;
  const surface = { ...joined(made), last: done };
  meshing = done ? null : { ...meshing, made: [] };
  post("surface", surface, [surface.vertices.buffer, surface.normals.buffer, surface.triangles.buffer]);
}

function stopMeshing() {
  meshing?.parts.return();
  meshing = null;
}

/** A device with a connection gets a last zero. */
function endSession() {
  stopMeshing();
  running = false;
  recording = false;
  session?.delete();
  session = null;
}

function carve(now) {
  lastCarving = now;
  if (!session.drill(burr, { sameStep: carving })) return;
  carving = true;
  post("edited", true);
}

async function beginNow({ samples, geometry, scene, setup, line: address, about }) {
  const palpate = await loaded;
  const made = scene ? palpate.scene(scene) : { volume: palpate.volume(samples, geometry) };
  const { volume } = made;
  let opened = null;
  try {
    if (address) {
      endSession(); // the device gets its zero before the next session asks for it
      opened = new Line(address);
      await opened.opens();
    }
    const begun = palpate.session(volume, { isovalue: made.isovalue, ...setup }, opened);
    endSession();
    [session, line, newest] = [begun, opened, null];
    actions.burr(0);
    const copy = volume.samples();
    const { type, size, spacing, origin, direction, minimum, maximum } = volume;
    post("ready", {
      isovalue: made.isovalue, samples: copy, type, size, spacing, origin, direction, minimum, maximum,
      isolated: sleeper !== null, settings: session.settings(), about,
    }, [copy.buffer]);
  } catch (error) {
    opened?.close();
    throw error;
  } finally {
    volume.delete(); // the session holds its samples
  }
  running = true;
  if (!turning) turns.port2.postMessage(null);
  turning = true;
}

const actions = {
  /** One after the other: a connection takes its time. */
  begin(what) {
    const next = lastBegin.then(() => beginNow(what));
    lastBegin = next.catch(() => {});
    return next;
  },
  read({ position, buttons, at }) {
    // Clocks of a page and its worker begin at other times.
    session.read(position, { buttons, measured: at - performance.timeOrigin });
  },
  puck: ({ number, bytes }) => session.puck(number, bytes),
  lose: () => session.lose(),
  command: ([name, members]) => session.command(name, members),
  /** The settings as they are then, also if this one was refused. */
  set([name, value]) {
    try {
      session.set(name, value);
    } finally {
      post("settings", session.settings());
    }
  },
  burr(radius) {
    burr = radius;
    carving = false;
  },
  undo: () => post("edited", session.undo()),
  redo: () => post("edited", session.redo()),
  surface(isovalue) {
    stopMeshing();
    meshing = { parts: session.surfaceParts(isovalue), made: [] };
    while (meshing && !running) meshBox(); // no ticks to keep
  },
  record() {
    session.record();
    recording = true;
  },
  recording() {
    recording = false;
    post("recording", session.recording());
  },
  report: () => post("report", session.report()),
  end() {
    running = false;
    session.stop();
  },
};
const withoutSession = new Set(["begin", "burr"]);

turns.port1.onmessage = turn;
onmessage = async ({ data }) => {
  for (const [name, argument] of Object.entries(data)) {
    try {
      if (session || withoutSession.has(name)) await actions[name](argument);
    } catch (error) {
      post("error", error.message);
    }
  }
};
