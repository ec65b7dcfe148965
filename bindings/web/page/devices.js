// What can hold the hand: "mouse", "spacenav", "simulated:OPTIONS" as on the command line, or the address of a Haply
// service. How a session with it begins, and reports of a SpaceMouse.

export const far = 75; // [device mm] from the middle, where the hand rests
const drawnForce = { stiffness: 0.5, stale_after: 0.08, limit: 3.3 }; // only drawn. A page reads its mouse 60 times a second
// As in `palpate touch`, and no more than a Touch has.
const deviceForce = { stiffness: 0.5, limit: 3.3, rate_limit: 2000, ramp: 0.25, start_below: 0.3 };

export const isService = (device) => /^wss?:/.test(device);
export const isSimulated = (device) => device.startsWith("simulated");

/** Volume and device, centre on centre, the front of the body towards the viewer. */
export function transformFor({ size, spacing, origin, direction }) {
  const middle = [0, 1, 2].map((row) => origin[row] + [0, 1, 2].reduce((sum, a) => sum + direction[3 * row + a] * spacing[a] * (size[a] - 1) * 0.5, 0));
  const longest = Math.max(...size.map((n, a) => n * spacing[a]));
  return { rotation: [[1, 0, 0], [0, 0, -1], [0, 1, 0]], translation: middle, scale: longest / 140 };
}
const sceneTransform = { rotation: [[1, 0, 0], [0, 0, -1], [0, 1, 0]], translation: [0, 0, 0], scale: 64 / 140 };

/** A SpaceMouse begins where the hand rests, in front of the volume. */
function inFront({ rotation, translation, scale }) {
  return { rotation, translation: translation.map((x, i) => x + scale * far * rotation[i][2]), scale };
}

/** The setup of a session with the device, and the address of its service if it has one. */
export function sessionWith(device, geometry) {
  if (isService(device)) {
    const { hostname, port } = new URL(device);
    return { line: device, setup: { device: `haply:host=${hostname},port=${port || 80}`, fit: true, settings: { force: deviceForce } } };
  }
  if (isSimulated(device)) return { setup: { device, fit: true, settings: { force: drawnForce } } };
  const transform = geometry ? transformFor(geometry) : sceneTransform;
  return { setup: { device, settings: { force: drawnForce, transform: device === "spacenav" ? inFront(transform) : transform } } };
}

/** What to do, or wait for, while nothing is touched. */
export function idleText(device) {
  if (isSimulated(device)) return "The simulated hand is on its way";
  return device === "mouse" ? "Move, and press to touch" : "Move the device to touch";
}

const waits = 64; // the bit of ForceFlag in palpate/force.hpp
/** The size of a snapshot's force, and what it waits for. */
export const forceText = ({ flags, force }) => `${Math.hypot(...force).toFixed(1)} N${flags & waits ? " until the hand is lifted," : ""}`;

/** Lets the visitor choose a SpaceMouse. False if none was chosen. */
export async function chooseSpaceMouse(report, unplugged) {
  const filters = [{ vendorId: 0x256f }, { vendorId: 0x046d, usagePage: 1, usage: 8 }]; // 3Dconnexion, Logitech
  const [chosen] = await navigator.hid.requestDevice({ filters });
  if (!chosen) return false;
  if (!chosen.opened) await chosen.open();
  chosen.oninputreport = ({ reportId, data }) =>
    report({ number: reportId, bytes: new Uint8Array(data.buffer, data.byteOffset, data.byteLength).slice() });
  navigator.hid.ondisconnect = (event) => event.device === chosen && unplugged();
  return true;
}
