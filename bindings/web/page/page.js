// The page: a mouse or finger moves the hand; pressing pushes it against the surface until the spring is as long
// as asked for. What it does goes through Hand, what it shows comes from there.
import { Hand } from "../hand.js";
import { load } from "../palpate.js";
import { drawHistogram, drawSlices, histogramOf, rangeOf } from "./charts.js";
import { chooseSpaceMouse, far, forceText, idleText, isService, isSimulated, sessionWith, transformFor } from "./devices.js";
import { Sound, contactOf, shake } from "./feedback.js";
import { chosenFiles, droppedFiles, lastAsked, readAddress, readFiles } from "./open.js";
import { Scene } from "./scene.js";
import { showSettings } from "./settings.js";

const $ = (id) => document.getElementById(id);
const headAddress = new URL("./visible_human_head.nrrd", import.meta.url);
const headMarks = { skin: 35, bone: 100 }; // [data units]
const headLayers = {
  name: "Skin and bone of the head",
  layers: [
    { name: "skin", level: 35, stiffness: 0.3, static_friction: 0.3, dynamic_friction: 0.2, puncture_force: 1.2, viscosity: 0.0002 },
    { name: "bone", level: 100, stiffness: 0.5, static_friction: 0.2, dynamic_friction: 0.15 },
  ],
};
const speed = 90; // [device mm/s] at which the hand approaches
const slowly = 15; // [device mm/s] while surfaces give way
const betweenReadings = 16; // [ms]
const betweenSlowFrames = 30; // [ms]

const scene = new Scene($("scene"));
let volume = null; // of the worker's answer `ready`
let snapshot = null;
let histogram = null;
let marks = {};
let level = 0;
let device = "mouse"; // of the session, see devices.js
let wanted = device; // of the session that was asked for last
let connecting = false;
let pressing = false;
let meshing = false; // a surface was asked for and has not come
let stale = false; // another one is needed
let recording = false;
let opened = {}; // of the volume: its name, levels that are known
let parts = []; // of the surface that is on its way
let shown = 0; // level of the surface
const hand = [0, 0, far];

function write(id, text) {
  if ($(id).textContent !== text) $(id).textContent = text;
}

let useModule = null;
const module = new Promise((compiled) => (useModule = compiled)); // by the worker
const loadCore = async () => load(await module);

let toldUntil = 0;
/** Shows a state, which stays for `least` ms or until the next action. */
function tell(text, least = 0) {
  if (performance.now() < toldUntil && least === 0) return;
  toldUntil = performance.now() + least;
  write("state", text);
}

for (const name of ["pointerdown", "keydown", "change"]) document.addEventListener(name, () => (toldUntil = 0), true);

/** Announces to those who do not see the page. */
const say = (text) => ($("said").textContent = text);
let touching = false;

/** In the list of volumes: one of its own, or another by its name. */
function showName() {
  $("own").hidden = opened.listed !== undefined;
  $("own").textContent = opened.name;
  $("volume").value = opened.listed ?? "own";
}

/** An error, which stays until the next action. The volume stays, too. */
function complain(error) {
  if (volume) showName();
  tell(`Error: ${error}`, Infinity);
  say(`Error: ${error}`);
}

const to = new Hand({
  module: (compiled) => useModule(compiled),
  ready({ about, ...made }) {
    if (connecting) toldUntil = 0;
    if (about.device === device) say(`${about.name} is open`);
    else say(about.device === "mouse" ? "The mouse moves the hand" : "Connected");
    opened = about;
    showName();
    device = about.device;
    connecting = false;
    $("notes").textContent = (opened.notes ?? []).join("; ");
    $("layersLabel").hidden = !opened.layers;
    volume = { ...made, oriented: opened.oriented, number: (volume?.number ?? 0) + 1 };
    snapshot = null;
    touching = false;
    showDevices();
    showAll(made.settings);
    scene.clear();
    meshing = false; // the worker has dropped the surface of the volume before
    hand[2] = far;
    histogram = histogramOf(volume);
    showMarks(opened.marks ?? {});
    useLevel(opened.level ?? Object.values(marks)[0] ?? made.isovalue ?? histogram.otsu);
    document.body.dataset.ready = "1";
    to.send("report");
  },
  snapshot(now) {
    if (snapshot) respond(contactOf(snapshot, now));
    snapshot = now;
    if (Number.isFinite(now.isovalue) && $("through").checked) level = now.isovalue;
    if (volume && Math.abs(level - shown) > 0.03 * (volume.maximum - volume.minimum)) remesh(); // pressed through
    if (now.constrained !== touching) say((touching = now.constrained) ? "In contact" : "No contact");
    tell(now.constrained ? `In contact: ${forceText(now)} at level ${now.isovalue.toFixed(0)}` : pressing ? "Approaching ..." : idleText(device));
  },
  surface(part) {
    parts.push(part);
    if (!part.last) return;
    scene.show(parts, transformFor(volume));
    keep();
    parts = [];
    meshing = false;
    document.body.dataset.surface = String(Number(document.body.dataset.surface ?? 0) + 1);
    if (stale) remesh();
  },
  settings: (all) => showAll(all),
  edited: () => remesh(),
  recording(text) {
    const link = $("save");
    URL.revokeObjectURL(link.href);
    link.href = URL.createObjectURL(new Blob([text], { type: "text/csv" }));
    link.hidden = false;
  },
  report({ device, problem, ticks, missed, lateness, work }) {
    if (problem) tell(problem, 2000);
    const us = (ns) => `${(ns / 1000).toFixed(0)} µs`;
    const rows = [["device", device], ["ticks", ticks], ["missed", missed], ["late, median", us(lateness.p50)], ["late, 99 %", us(lateness.p99)],
      ["late, 99.9 %", us(lateness.p999)], ["late at most", us(lateness.max)], ["work, median", us(work.p50)], ["sleeps between ticks", volume.isolated ? "yes" : "no, until the page is loaded again"]];
    const part = (kind, text) => Object.assign(document.createElement(kind), { textContent: text });
    $("report").replaceChildren(...rows.flatMap(([name, value]) => [part("dt", name), part("dd", value)]));
  },
  error(text) {
    meshing = false;
    if (connecting) use("mouse"); // the session before has ended for it
    complain(text);
  },
});

const showAll = (all) => showSettings($("usual"), $("rest"), all, (name, value) => to.send("set", [name, value]));

let sound = null;
/** To a contact, in addition to the picture. */
function respond(contact) {
  sound?.hear(contact);
  if ($("shakes").checked && contact.push > 0) shake(navigator.getGamepads(), contact);
}

/** Which device holds the hand, on the buttons that connect and disconnect. */
function showDevices() {
  $("lift").hidden = device === "mouse"; // which lifts itself
  for (const [id, is, name] of [["connect", isService, "the Inverse3"], ["puck", (one) => one === "spacenav", "the SpaceMouse"], ["simulate", isSimulated, "the simulated hand"]]) {
    $(id).disabled = false;
    $(id).classList.toggle("on", is(device));
    $(id).textContent = `${is(device) ? "Disconnect" : "Connect"} ${name}`;
  }
}

/** For visits without a network; after the first picture, which should not wait for it. */
function keep() {
  if (!document.body.dataset.surface) navigator.serviceWorker?.register(new URL("../offline.js", import.meta.url)).catch(() => {});
}

function remesh() {
  stale = meshing;
  if (stale) return;
  meshing = true;
  parts = [];
  shown = level;
  to.send("surface", level);
}

/** Levels by name: on the histogram, and as buttons. */
function showMarks(named) {
  marks = named;
  $("marks").replaceChildren(...Object.entries(marks).map(([name, value]) => {
    const button = document.createElement("button");
    button.textContent = `${name[0].toUpperCase()}${name.slice(1)}`;
    button.onclick = () => useLevel(value);
    return button;
  }));
}

function useLevel(value) {
  level = value;
  const slider = $("isovalue");
  [slider.min, slider.max, slider.step] = [volume.minimum, volume.maximum, (volume.maximum - volume.minimum) / 500];
  slider.value = value;
  $("isovalueText").textContent = value.toFixed(1);
  to.command("isovalue", { value });
  remesh();
}

/** Asks for a session. What is known of the volume comes back with `ready`. */
function begin(data, using = wanted) {
  if (recording) setRecording(false); // the worker still has its session
  const { geometry, samples, scene: made, ...about } = data;
  $("through").checked = $("layers").checked = $("drill").checked = false;
  to.send("burr", 0);
  const { line, setup } = sessionWith(using, geometry);
  [wanted, connecting] = [using, line !== undefined];
  const isovalue = () => about.level ?? Object.values(about.marks ?? {})[0] ?? histogramOf({ samples, ...rangeOf(samples) }).otsu;
  to.send("begin", {
    samples, geometry, scene: made, line, about: { ...about, device: using },
    setup: { ...(made ? {} : { isovalue: isovalue() }), volume: about.name, ...setup },
  }, samples ? [samples.buffer] : []);
}

/** The same volume with another device. */
function use(name) {
  if (isService(name)) tell("Connecting ...", Infinity);
  const { size, spacing, origin, direction, samples } = volume;
  begin({ ...opened, level, samples: samples.slice(), geometry: { size, spacing, origin, direction } }, name);
}

async function useSpaceMouse() {
  const report = (bytes) => device === "spacenav" && to.send("puck", bytes);
  if (await chooseSpaceMouse(report, () => device === "spacenav" && use("mouse"))) use("spacenav");
}

const beginLast = lastAsked((data) => begin(data), (error) => complain(error.message));
function open(read) {
  toldUntil = 0;
  tell("Loading ...");
  beginLast(read);
}

const openHead = () => open(async () => ({ ...(await readAddress(headAddress, loadCore)), marks: headMarks, layers: headLayers, listed: "head" }));

// The hand. It is moved and read by a timer: frames come late where pictures take long to draw.
let then = performance.now();
function moveHand() {
  const now = performance.now();
  const dt = Math.min(0.1, (now - then) / 1000);
  then = now;
  moveByKeys(dt);
  if (device !== "mouse" && snapshot && scene.transform) hand.splice(0, 3, ...scene.device(snapshot.hip));
  else if (snapshot && scene.transform) {
    const pull = scene.device(snapshot.scp)[2] - hand[2];
    if (!pressing) rest(dt);
    else if (!snapshot.constrained) hand[2] = Math.max(-far, hand[2] - speed * dt);
    else {
      const most = ($("through").checked || $("layers").checked ? slowly : speed) * dt;
      hand[2] += Math.max(-most, Math.min(most, pull - Number($("press").value)));
    }
  }
  if (volume && !document.hidden) to.read(hand);
}

let lifted = false;
/** Goes back in front of the volume, and leaves whatever still holds the proxy, such as a closed shell. */
function rest(dt) {
  hand[2] = Math.min(far, hand[2] + speed * dt);
  const isHeld = hand[2] === far && snapshot.constrained;
  if (isHeld && !lifted) to.command("lift");
  lifted = isHeld;
}

let drawnAt = 0;
function frame(now) {
  requestAnimationFrame(frame);
  if (scene.isSlow && now - drawnAt < betweenSlowFrames) return;
  drawnAt = now;
  write("pressText", `${$("press").value} mm`);
  scene.draw(snapshot, hand);
  if (volume) {
    drawHistogram($("histogram"), histogram, level, marks);
    if (snapshot) drawSlices($("slices"), volume, snapshot.scp);
  }
}

const canvas = $("scene");
const follow = (event) => {
  [hand[0], hand[1]] = scene.under(event, 0);
};
const setPressing = (on) => {
  pressing = on;
  if ($("drill").checked) to.send("burr", drills() ? drillRadius() : 0); // each press is a step of undo
};
const drills = () => $("drill").checked && (pressing || device !== "mouse");
const drillRadius = () => 2.5 * Math.max(...volume.spacing);
canvas.addEventListener("pointermove", follow);
canvas.addEventListener("pointerdown", (event) => {
  canvas.setPointerCapture(event.pointerId);
  follow(event);
  setPressing(true);
});
for (const name of ["pointerup", "pointercancel"]) canvas.addEventListener(name, () => setPressing(false));
canvas.addEventListener("wheel", (event) => {
  event.preventDefault();
  $("press").value = Number($("press").value) - Math.sign(event.deltaY) * 0.5;
}, { passive: false });

const held = new Set();
canvas.addEventListener("keydown", (event) => {
  if (event.key.startsWith("Arrow") || event.key === " ") event.preventDefault();
  if (event.key === " " && !pressing) setPressing(true);
  if (event.key === "+") $("press").stepUp();
  if (event.key === "-") $("press").stepDown();
  held.add(event.key);
});
canvas.addEventListener("keyup", (event) => {
  held.delete(event.key);
  if (event.key === " ") setPressing(false);
});
canvas.addEventListener("blur", () => {
  held.clear();
  if (pressing) setPressing(false);
});
function moveByKeys(dt) {
  const way = (more, less) => ((held.has(more) ? 1 : 0) - (held.has(less) ? 1 : 0)) * 50 * dt;
  hand[0] += way("ArrowRight", "ArrowLeft");
  hand[1] += way("ArrowUp", "ArrowDown");
}

// The panel.
$("volume").onchange = ({ target: { value } }) => (value === "head" ? openHead() : open(async () => ({ scene: value, name: value, listed: value })));
for (const id of ["file", "folder"]) $(id).onchange = ({ target }) => target.files.length > 0 && open(() => readFiles(chosenFiles(target.files), loadCore));
$("remote").onsubmit = (event) => {
  event.preventDefault();
  open(() => readAddress($("address").value, loadCore));
};
document.ondragover = (event) => event.preventDefault();
document.ondrop = (event) => {
  event.preventDefault();
  const files = droppedFiles(event.dataTransfer.items);
  open(async () => readFiles(await files, loadCore));
};
$("haply").onsubmit = (event) => {
  event.preventDefault();
  use(isService(device) ? "mouse" : $("service").value);
};
$("puckLine").hidden = !navigator.hid;
$("puck").onclick = () => (device === "spacenav" ? use("mouse") : useSpaceMouse().catch((error) => complain(error.message)));
$("simulated").onsubmit = (event) => {
  event.preventDefault();
  use(isSimulated(device) ? "mouse" : `simulated:hand=${$("motion").value},loop=yes`);
};
$("isovalue").oninput = ({ target }) => useLevel(Number(target.value));
$("histogram").onclick = (event) => {
  event.preventDefault();
  const box = $("histogram").getBoundingClientRect();
  useLevel(volume.minimum + ((event.clientX - box.left) / box.width) * (volume.maximum - volume.minimum));
};
$("through").onchange = ({ target }) => {
  to.command("penetrability", target.checked ? { on: true, threshold: 3, range_count: 1, range_1: { low: level, high: volume.maximum } } : { on: false });
  if (!target.checked) useLevel(Number($("isovalue").value)); // back to where it began
};
$("layers").onchange = ({ target }) => to.command("layers", target.checked ? { layers: opened.layers } : {});
$("drill").onchange = () => to.send("burr", drills() ? drillRadius() : 0);
$("sound").onclick = ({ target }) => {
  if (sound) sound.close();
  sound = sound ? null : new Sound();
  target.setAttribute("aria-pressed", String(sound !== null));
};
addEventListener("gamepadconnected", () => ($("shakesLabel").hidden = false));
$("undo").onclick = () => to.send("undo");
$("redo").onclick = () => to.send("redo");
$("lift").onclick = () => to.command("lift");
function setRecording(on) {
  recording = on;
  $("record").setAttribute("aria-pressed", String(on));
  $("record").textContent = on ? "End the recording" : "Record";
  to.send(on ? "record" : "recording");
}
$("record").onclick = () => setRecording(!recording);
setInterval(() => volume && to.send("report"), 1000);
setInterval(moveHand, betweenReadings);
requestAnimationFrame(frame);
const address = new URLSearchParams(location.search).get("volume");
if (address) {
  $("address").value = address;
  open(() => readAddress(address, loadCore));
} else {
  openHead();
}
