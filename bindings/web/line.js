// The WebSocket of a device in the worker. Messages wait here until the session takes them; nothing blocks.

const longestMessage = 2 ** 20; // [characters]
const mostWaiting = 256; // messages
const mostUnsent = 65536; // [bytes]

export class Line {
  /** For example ws://127.0.0.1:10001. */
  constructor(address) {
    this.address = address;
    this.drop("not connected yet");
  }
  get isOpen() {
    return this.socket?.readyState === WebSocket.OPEN;
  }
  /** Resolves when the service has said what is attached. */
  async opens() {
    this.connect();
    const { socket } = this;
    await new Promise((resolve, reject) => {
      socket.addEventListener("message", resolve);
      socket.addEventListener("close", () => reject(new Error(
        `nothing to talk to at ${this.address}: install Haply's Inverse Service (haply-inverse-service) and start it`)));
      setTimeout(() => reject(new Error(`the service at ${this.address} does not say what is attached`)), 2000);
    }).catch((error) => {
      this.drop(error.message);
      throw error;
    });
  }
  /** True if it is open and the first message is there. Otherwise it begins to connect. */
  connect() {
    if (this.isOpen) return this.waiting.length > 0;
    if (this.socket?.readyState === WebSocket.CONNECTING) return false;
    this.drop("connecting");
    const socket = (this.socket = new WebSocket(this.address));
    socket.binaryType = "arraybuffer";
    socket.onmessage = ({ data }) => {
      if (socket !== this.socket) return;
      const tooMuch = data.length > longestMessage || this.waiting.length >= mostWaiting;
      if (tooMuch) this.drop("it sends too much");
      else this.waiting.push(data);
    };
    socket.onclose = ({ reason }) => socket === this.socket && this.drop(reason || "the connection was closed");
    return false;
  }
  send(message) {
    if (!this.isOpen) return false;
    if (this.socket.bufferedAmount > mostUnsent) {
      this.drop("it takes no messages");
      return false;
    }
    this.socket.send(message);
    return true;
  }
  /** The oldest message, or null. */
  next() {
    return this.waiting.shift() ?? null;
  }
  close() {
    this.drop("closed");
  }
  drop(why) {
    this.error = why;
    this.waiting = [];
    const socket = this.socket;
    this.socket = null;
    socket?.close();
  }
}
