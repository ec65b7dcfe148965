// A stand-in for Haply's Inverse Service on the loopback, in JavaScript: it answers each message with one.
import { installed } from "./browser.mjs";

const id = "049D";
const status = { calibrated: true, in_use: false, power_supply: true, ready: true, started: true };

export const felt = 0.2; // [N]
export const inFront = -0.29; // [m, service axes] of the face, as the page fits the head

/** Connects the page to the service there. */
export const connect = (page, address) => page.evaluate((at) => {
  document.getElementById("service").value = at;
  document.getElementById("connect").click();
}, address);

/** Its hand goes from in front of the head towards it until it feels a force, and stays there. Without one it goes back and
 * tries again: no force begins while a hand presses. */
export class Service {
  forces = []; // { at [ms], size [N] }
  y = inFront; // [m, service axes]
  way = 0.0003; // [m] to the next place
  connections = 0;
  answers = true;
  closedAt = 0; // [ms]

  constructor(port = 0) {
    const { WebSocketServer } = installed("ws");
    this.server = new WebSocketServer({ host: "127.0.0.1", port });
    this.server.on("connection", (socket) => {
      ++this.connections;
      socket.on("close", () => (this.closedAt = Date.now()));
      const config = { type: "inverse3", device_info: { major_version: 7, minor_version: 4, id }, basis: { permutation: "XYZ" } };
      socket.send(JSON.stringify({ session_id: 7, inverse3: [{ device_id: id, config, state: { cursor_position: this.place() }, status }] }));
      socket.on("message", (message) => {
        const { values } = JSON.parse(message).inverse3?.[0].commands.set_cursor_force ?? {};
        if (values) this.forces.push({ at: Date.now(), size: Math.hypot(values.x, values.y, values.z) });
        if (!(this.forces.at(-1)?.size > felt)) this.move();
        if (this.answers) socket.send(JSON.stringify({ inverse3: [{ device_id: id, state: { cursor_position: this.place() } }] }));
      });
    });
  }
  move() {
    this.y += this.way;
    if (this.y > inFront + 0.04) this.way = -Math.abs(this.way);
    if (this.y < inFront) this.way = Math.abs(this.way);
  }
  place() {
    return { x: -0.007, y: this.y, z: 0.13 };
  }
  async listens() {
    if (!this.server.address()) await new Promise((resolve) => this.server.once("listening", resolve));
    return `ws://127.0.0.1:${this.server.address().port}`;
  }
  drop() {
    for (const client of this.server.clients) client.terminate();
  }
  close() {
    this.drop();
    this.server.close();
  }
  /** Resolves when a message fulfils the condition. */
  async until(condition) {
    while (!condition(this.forces.at(-1) ?? { size: 0 })) await new Promise((resolve) => setTimeout(resolve, 5));
  }
  /** [ms] from a time until the last force above zero within so many ms; 0 if there was none since. */
  lastForceSince(from, within = Infinity) {
    const last = this.forces.findLast(({ at, size }) => size > 0 && at < from + within);
    return Math.max(0, (last?.at ?? 0) - from);
  }
}
