// What a contact sounds like, and how it shakes a gamepad. For those who hold no haptic device.

const strongest = 3.3; // [N]
const fastest = 150; // [mm/s]
const silentAfter = 0.1; // [s] without a snapshot

const part = (value, whole) => Math.min(1, Math.max(0, value / whole));

/** Between two snapshots: how hard the surface was struck, how strongly it pushes and how fast the proxy scrapes, each 0 to 1. */
export function contactOf(before, now) {
  const seconds = now.time - before.time;
  const push = part(Math.hypot(...now.force), strongest);
  if (!now.constrained || push === 0 || !(seconds > 0)) return { strike: 0, push: 0, scrape: 0 };
  const speed = (name) => Math.hypot(...now[name].map((x, i) => x - before[name][i])) / seconds;
  return {
    strike: before.constrained ? 0 : Math.max(0.1, part(speed("hip"), fastest)),
    push,
    scrape: before.constrained ? push * part(speed("scp"), fastest) : 0,
  };
}

/** Noise, loud when the proxy scrapes and bright when it is fast, and a knock for each strike. */
export class Sound {
  constructor(context = new AudioContext()) {
    this.context = context;
    const noise = context.createBuffer(1, context.sampleRate, context.sampleRate);
    const samples = noise.getChannelData(0);
    for (let i = 0, seed = 1; i < samples.length; ++i) {
      seed = (Math.imul(seed, 1664525) + 1013904223) >>> 0;
      samples[i] = seed / 2 ** 31 - 1;
    }
    this.noise = noise;
    this.filter = new BiquadFilterNode(context, { type: "bandpass", frequency: 300, Q: 0.8 });
    this.scraping = new GainNode(context, { gain: 0 });
    this.source = new AudioBufferSourceNode(context, { buffer: noise, loop: true });
    this.source.connect(this.filter).connect(this.scraping).connect(context.destination);
    this.source.start();
  }
  /** From time `at` [s, of the context] on. */
  hear({ strike, scrape }, at = this.context.currentTime) {
    this.filter.frequency.setTargetAtTime(300 + 1500 * scrape, at, 0.02);
    const { gain } = this.scraping;
    gain.cancelScheduledValues(at);
    gain.setTargetAtTime(0.5 * scrape, at, 0.015);
    gain.setTargetAtTime(0, at + silentAfter, 0.02);
    if (strike === 0) return;
    const knock = new AudioBufferSourceNode(this.context, { buffer: this.noise });
    const dull = new BiquadFilterNode(this.context, { type: "lowpass", frequency: 250 + 500 * strike });
    const fading = new GainNode(this.context, { gain: 0.8 * strike });
    fading.gain.setTargetAtTime(0, at, 0.02);
    knock.connect(dull).connect(fading).connect(this.context.destination);
    knock.start(at, 0, 0.2);
  }
  close() {
    this.context.close();
  }
}

/** Until the next snapshot, and a little longer. */
export function shake(gamepads, { strike, push, scrape }) {
  for (const pad of gamepads) {
    pad?.vibrationActuator?.playEffect("dual-rumble", { duration: 60, strongMagnitude: Math.max(strike, 0.4 * push), weakMagnitude: scrape }).catch(() => {});
  }
}
