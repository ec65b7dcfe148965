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
  /** Names for recordings: of the device, and of the volume as the command line opens it. */
  device?: string;
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
  ticks: number;
  missed: number;
  overruns: number;
  unrecorded: number;
  period: Times;
  lateness: Times;
  work: Times;
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
  /** A tick, now. False once the session has ended. */
  step(): boolean;
  /** A tick at a time of the caller's, without statistics: the same calls give the same bits. */
  stepAt(time: number, position?: ArrayLike<number>, more?: { buttons?: number; age?: number }): boolean;
  /** When the next step() is due, by performance.now() [ms]. */
  readonly due: number;
  stop(): void;
  /** For example command("isovalue", { value: 40 }) or command("penetrability", { on: true, ... }). */
  command(name: string, members?: Record<string, unknown>): void;
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

export interface Palpate {
  volume(samples: Samples, geometry: Geometry): Volume;
  /** A synthetic volume, for example "sphere:64x64x64". */
  scene(specification: string): { volume: Volume; isovalue: number; description: string };
  session(volume: Volume, setup: SessionSetup): Session;
}

export function joined(parts: Surface[]): Surface;

export function load(wasm?: ArrayBuffer | Uint8Array): Promise<Palpate>;
