// The page's side of a session in a Worker: sends readings and commands, hears snapshots.

/** What is said when a session ends by itself. */
export const endedBy = (why, remedy) => `the session has ended, and there is no force any more: ${why}. ${remedy}`;
/** The last snapshot of such a session. */
export const withoutForce = (snapshot) => ({ ...snapshot, force: [0, 0, 0], constrained: false });

export class Hand {
  /** `hear` has a function for each message of the worker: module, ready, snapshot, surface, edited, recording,
   * report, error. */
  constructor(hear) {
    this.worker = new Worker(new URL("./worker.js", import.meta.url), { type: "module" });
    let last = null;
    this.worker.onmessage = ({ data }) => {
      for (const [name, value] of Object.entries(data)) hear[name]?.(value);
      last = data.snapshot ?? last;
    };
    this.worker.onerror = ({ message }) => {
      this.worker.terminate(); // which closes the connection to a device
      if (last) hear.snapshot?.(withoutForce(last));
      hear.error?.(endedBy(message ?? "its worker could not be loaded", "Load the page again"));
    };
    // A page that is hidden reads nothing; the force need not wait until that is stale.
    document.addEventListener("visibilitychange", () => document.hidden && this.send("lose", null));
  }
  send(name, argument = null, transfer = []) {
    this.worker.postMessage({ [name]: argument }, transfer);
  }
  /** A reading [device mm], measured now. */
  read(position, buttons = 0) {
    this.send("read", { position, buttons, at: performance.timeOrigin + performance.now() });
  }
  command(name, members = {}) {
    this.send("command", [name, members]);
  }
}
