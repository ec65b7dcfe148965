// The page's side of a session in a Worker: sends readings and commands, hears snapshots.

export class Hand {
  /** `hear` has a function for each message of the worker: ready, snapshot, surface, edited, recording,
   * report, error. */
  constructor(hear) {
    this.worker = new Worker(new URL("./worker.js", import.meta.url), { type: "module" });
    this.worker.onmessage = ({ data }) => {
      for (const [name, value] of Object.entries(data)) hear[name]?.(value);
    };
    this.worker.onerror = (event) => hear.error?.(event.message);
    // A page that is hidden draws no frames, so nothing would be read; the force need not wait until that is stale.
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
