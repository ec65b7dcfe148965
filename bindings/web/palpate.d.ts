// Lengths in mm, forces in N, times in s unless a comment says otherwise.
export type Vector = [number, number, number];
export type Samples = Uint8Array | Uint8ClampedArray | Int16Array | Uint16Array | Float32Array;

export interface Geometry {
  size: Vector;
  spacing?: Vector;
  /** Physical position of the first sample (LPS). */
  origin?: Vector;
  /** Three rows; the columns are the unit vectors of the grid's axes. */
  direction?: number[];
}

export class Volume {
  readonly type: "uint8" | "int16" | "uint16" | "float32";
  readonly size: Vector;
  readonly spacing: Vector;
  readonly origin: Vector;
  readonly direction: number[];
  readonly minimum: number;
  readonly maximum: number;
  /** A copy, x fastest. */
  samples(): Samples;
  delete(): void;
}

/** Settings have the names and members that recordings have (docs/recordings.md). */
export interface SessionSetup {
  isovalue: number;
  field?: "linear" | "cubic";
  solid?: "above" | "below";
  background?: number;
  /** Ticks per second, 250 to 8000. */
  rate?: number;
  /** Force, device limits, transform, friction, penetrability, layers, tool. */
  settings?: Record<string, unknown>;
  /** Clutch and dead-man buttons, plausible speed, overrun. */
  session?: Record<string, unknown>;
  /** Names for recordings: of the device, and of the volume as the command line opens it. "simulated" and, with a Line,
   * "haply" are native devices, with options as on the command line: "haply:host=127.0.0.1,port=10001". */
  device?: string;
  /** The transform that fits the volume into the device's workspace, in place of that of the settings. */
  fit?: boolean;
  volume?: string;
}

export interface Snapshot {
  number: number;
  time: number;
  hip: Vector;
  scp: Vector;
  /** Device axes. */
  force: Vector;
  /** Out of the solid; zero in the air. */
  normal: Vector;
  constrained: boolean;
  density: number;
  isovalue: number;
  flags: number;
  /** The layer that is touched, -1 for none, and how many enclose the SCP. */
  touched: number;
  inside: number;
  /** Of the samples: 0 at the start. */
  version: number;
  missed: number;
  /** In use [N/mm]. */
  stiffness: number;
  /** 1 is ready; the order is that of DeviceStatus. */
  status: number;
}

/** [ns] */
export interface Times { p50: number; p99: number; p999: number; max: number }
export interface Report {
  /** The device as it reports itself, and what is wrong with it, or "". */
  device: string;
  problem: string;
  ticks: number;
  missed: number;
  overruns: number;
  unrecorded: number;
  period: Times;
  lateness: Times;
  work: Times;
}

/** A number of a session that can be changed. */
export interface Setting {
  /** "force.stiffness" */
  name: string;
  unit: string;
  about: string;
  least: number;
  /** Infinity, or a huge number, if there is no limit. */
  most: number;
  value: number;
}

export interface Surface {
  vertices: Float32Array;
  /** Of a cubic field; else empty. */
  normals: Float32Array;
  triangles: Uint32Array;
}

export class Session {
  /** The newest reading [device mm]; `measured` by performance.now() [ms]. */
  read(position: ArrayLike<number>, more?: { buttons?: number; measured?: number }): void;
  /** The device is gone until the next reading. */
  lose(): void;
  /** A report of a 3D mouse (WebHID) if the session's device is "spacenav". It moves the hand, and read() is only a
   * sign of life. */
  puck(number: number, bytes: Uint8Array): void;
  /** A tick, now. False once the session has ended. */
  step(): boolean;
  /** A tick at a time of the caller's, without statistics: the same calls give the same bits. */
  stepAt(time: number, position?: ArrayLike<number>, more?: { buttons?: number; age?: number }): boolean;
  /** When the next step() is due, by performance.now() [ms]. */
  readonly due: number;
  stop(): void;
  /** For example command("isovalue", { value: 40 }) or command("penetrability", { on: true, ... }). */
  command(name: string, members?: Record<string, unknown>): void;
  /** Of force, friction and device limits. Stiffness and damping are those in use: at most what the device renders stably. */
  settings(): Setting[];
  set(name: string, value: number): void;
  /** { stroke: {...} } or { fill: {...} }. */
  edit(edit: Record<string, unknown>, more?: { sameStep?: boolean }): void;
  /** Carves along the proxy's way since the last call while it touches. True if samples changed. */
  drill(radius: number, more?: { sameStep?: boolean }): boolean;
  undo(): boolean;
  redo(): boolean;
  snapshot(): Snapshot;
  report(): Report;
  record(begun?: Date): void;
  /** Ends the recording: the text that `palpate replay --validate` takes. */
  recording(): string;
  /** Of the samples as they are. */
  surface(isovalue: number): Surface;
  /** The same in parts, box by box, so that ticks can run in between. joined() makes one mesh of them. */
  surfaceParts(isovalue: number, cells?: Vector): Generator<Surface, void>;
  replay(path: ArrayLike<number>[], rate?: number): Snapshot[];
  delete(): void;
}

/** A connection to a device: Line in line.js is one. No function waits. */
export interface LineOfDevice {
  readonly isOpen: boolean;
  /** Why it is not. */
  readonly error: string;
  /** True if it is open and the first message is there. Otherwise it begins to connect. */
  connect(): boolean;
  send(message: string): boolean;
  /** The oldest message, or null. */
  next(): string | ArrayBuffer | null;
  close(): void;
}

/** A file and its name, or its path in a folder. */
export interface GivenFile { path: string; bytes: Uint8Array }
export interface ReadVolume {
  volume: Volume;
  /** "NRRD", "MetaImage", "NIfTI" or "Analyze". */
  format: string;
  /** False if the file does not say how its axes lie in the body. */
  oriented: boolean;
  /** What was chosen, assumed and converted, one sentence each. */
  notes: string[];
}

export interface Palpate {
  /** For load() in another page or Worker of the same origin. */
  readonly module: WebAssembly.Module;
  /** Reads NRRD, MetaImage or NIfTI with the native readers. `files` are all that the format takes: for example a header
   * and its samples, of which `path` names the header. The first one if it is left out. */
  read(files: GivenFile[], path?: string): Promise<ReadVolume>;
  volume(samples: Samples, geometry: Geometry): Volume;
  /** A synthetic volume, for example "sphere:64x64x64". */
  scene(specification: string): { volume: Volume; isovalue: number; description: string };
  /** With a line, the session has a device of its own (docs/web.md), and read() is only a sign of life. */
  session(volume: Volume, setup: SessionSetup, line?: LineOfDevice | null): Session;
}

export function joined(parts: Surface[]): Surface;

export function load(wasm?: ArrayBuffer | Uint8Array | WebAssembly.Module): Promise<Palpate>;
