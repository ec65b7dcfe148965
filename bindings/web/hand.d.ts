// A session in a Worker of the browser. Not for Node.
import type { Geometry, Report, Samples, SessionSetup, Setting, Snapshot, Surface, Vector } from "./palpate.js";

/** The session has begun: its samples, which the page owns, and their geometry. */
export interface Ready extends Required<Geometry> {
  /** Of a scene. */
  isovalue?: number;
  samples: Samples;
  type: "uint8" | "int16" | "uint16" | "float32";
  minimum: number;
  maximum: number;
  /** Whether the loop sleeps between ticks (docs/web.md). */
  isolated: boolean;
  settings: Setting[];
  /** As it was sent with the request. */
  about: unknown;
}

/** Called with the messages of the worker. */
export interface Hearing {
  /** The first one: what load() takes in this page. */
  module?(compiled: WebAssembly.Module): void;
  ready?(made: Ready): void;
  /** Around 60 times a second. */
  snapshot?(now: Snapshot): void;
  /** A part of the surface that was asked for; it is whole with the last one. A newer request ends an older one. */
  surface?(part: Surface & { last: boolean }): void;
  /** False if there was nothing to undo or redo. */
  edited?(changed: boolean): void;
  recording?(text: string): void;
  report?(report: Report): void;
  /** After each request that changes one. */
  settings?(all: Setting[]): void;
  /** If it ends the session, a snapshot without force comes before it. */
  error?(message: string): void;
}

/** The functions of Session by name, with their argument. Surfaces are made by the thread that renders. */
export interface Requests {
  /** Either a scene, or samples and their geometry. Ends the session before it, unless it fails. */
  begin: { scene?: string; samples?: Samples; geometry?: Geometry; setup: Omit<SessionSetup, "isovalue"> & { isovalue?: number };
    /** The address of a device's service, for example ws://127.0.0.1:10001. */
    line?: string;
    /** Comes back with the answer. */
    about?: unknown };
  read: { position: Vector; buttons: number; at: number };
  /** A report of a 3D mouse, for the device "spacenav". */
  puck: { number: number; bytes: Uint8Array };
  lose: null;
  command: [name: string, members: Record<string, unknown>];
  /** A setting by name. */
  set: [name: string, value: number];
  /** Radius [mm] of the burr that drills, 0 for none. Each call begins a step of undo. */
  burr: number;
  undo: null;
  redo: null;
  /** At this isovalue. */
  surface: number;
  record: null;
  recording: null;
  report: null;
  end: null;
}

export function endedBy(why: string, remedy: string): string;
export function withoutForce(snapshot: Snapshot): Snapshot;

export class Hand {
  constructor(hear: Hearing);
  send<Name extends keyof Requests>(name: Name, argument?: Requests[Name], transfer?: Transferable[]): void;
  /** A reading [device mm], measured now. */
  read(position: ArrayLike<number>, buttons?: number): void;
  command(name: string, members?: Record<string, unknown>): void;
}
