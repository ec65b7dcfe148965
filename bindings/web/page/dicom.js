// Reads the slices of a DICOM series, or a file of several frames, into samples and a geometry in LPS. Pixels that
// are compressed are refused: browsers have no decoder for medical JPEG.
import { geometryOf, inflated, isDicom } from "./files.js";

const syntaxes = {
  "1.2.840.10008.1.2": {}, "1.2.840.10008.1.2.1": { explicit: true }, "1.2.840.10008.1.2.2": { explicit: true, big: true },
  "1.2.840.10008.1.2.1.99": { explicit: true, deflated: true },
};
const longForms = new Set(["OB", "OD", "OF", "OL", "OV", "OW", "SQ", "UC", "UN", "UR", "UT", "SV", "UV"]);
const open = 0xffffffff; // a length that is not told

/** Elements by tag, for example "0020000e": bytes, or for a sequence its items. */
class Reader {
  constructor(bytes, { explicit = false, big = false }) {
    Object.assign(this, { bytes, explicit, little: !big, at: 0, view: new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength) });
  }
  short() {
    this.at += 2;
    return this.view.getUint16(this.at - 2, this.little);
  }
  long() {
    this.at += 4;
    return this.view.getUint32(this.at - 4, this.little);
  }
  tag() {
    const group = this.short();
    return group.toString(16).padStart(4, "0") + this.short().toString(16).padStart(4, "0");
  }
  /** Up to `end`, or to the delimiter of an item without a length. */
  elements(end, depth = 0) {
    if (depth > 16) throw new Error("this DICOM has sequences nested too deep");
    const set = new Map();
    while (this.at < end) {
      const tag = this.tag();
      if (tag === "fffee00d") {
        this.at += 4;
        break;
      }
      let kind = "";
      if (this.explicit) {
        kind = String.fromCharCode(this.bytes[this.at], this.bytes[this.at + 1]);
        this.at += 2;
      }
      let size;
      if (this.explicit && !longForms.has(kind)) size = this.short();
      else {
        if (this.explicit) this.at += 2;
        size = this.long();
      }
      if (size !== open && this.at + size > end) throw new Error(`element ${tag} of this DICOM reaches beyond its end`);
      if (kind === "SQ" || size === open || tag === "52009229" || tag === "52009230") {
        if (tag === "7fe00010") throw new Error("compressed DICOM is not read in the browser: convert it first, for example with `palpate convert`");
        set.set(tag, this.items(size === open ? end : this.at + size, depth));
      } else if (this.isSequence(kind, size, tag)) set.set(tag, this.items(this.at + size, depth));
      else {
        set.set(tag, this.bytes.subarray(this.at, this.at + size));
        this.at += size;
      }
    }
    return set;
  }
  /** Implicit syntax does not tell sequences from values: they begin with the tag of an item. */
  isSequence(kind, size, tag) {
    return kind === "" && tag !== "7fe00010" && size >= 8 && this.view.getUint32(this.at, true) === 0xe000fffe;
  }
  items(end, depth) {
    const list = [];
    while (this.at < end) {
      const tag = this.tag();
      const size = this.long();
      if (tag === "fffee0dd") break;
      if (tag !== "fffee000") throw new Error(`a sequence of this DICOM has element ${tag} in place of an item`);
      if (size !== open && this.at + size > end) throw new Error("an item of this DICOM reaches beyond its end");
      list.push(this.elements(size === open ? end : this.at + size, depth + 1));
    }
    return list;
  }
}

const text = (bytes) => new TextDecoder().decode(bytes).replace(/[\0 ]+$/, "").trim();

async function parsed(bytes) {
  let end = 132;
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  while (end + 8 <= bytes.length && view.getUint16(end, true) === 2) {
    const isLong = longForms.has(String.fromCharCode(bytes[end + 4], bytes[end + 5]));
    end += isLong ? 12 + view.getUint32(end + 8, true) : 8 + view.getUint16(end + 6, true);
  }
  const head = new Reader(bytes.subarray(132, end), { explicit: true }).elements(end - 132);
  const name = text(head.get("00020010") ?? new Uint8Array());
  const syntax = syntaxes[name];
  if (!syntax) throw new Error(`DICOM of transfer syntax ${name} is not read in the browser: convert it first, for example with \`palpate convert\``);
  const body = syntax.deflated ? await inflated(bytes.subarray(end), "deflate-raw") : bytes.subarray(end);
  return { set: new Reader(body, syntax).elements(body.length), little: !syntax.big };
}

/** The frames of a file: each with the header that holds for it. */
function framesOf({ set, little }) {
  const whole = (tag, otherwise) => {
    const value = set.get(tag);
    return value?.length >= 2 ? new DataView(value.buffer, value.byteOffset).getUint16(0, little) : otherwise;
  };
  const pixels = set.get("7fe00010");
  if (!pixels) return []; // an index, a report
  if (whole("00280002", 1) !== 1) throw new Error("DICOM in colour is not read");
  const format = { rows: whole("00280010"), columns: whole("00280011"), bits: whole("00280100"), stored: whole("00280101", whole("00280100")), signed: whole("00280103", 0) === 1 };
  if (format.bits !== 8 && format.bits !== 16) throw new Error(`DICOM of ${format.bits} bits is not read`);
  const count = Number(text(set.get("00280008") ?? new Uint8Array())) || 1;
  const size = (format.rows * format.columns * format.bits) / 8;
  if (!(size > 0) || pixels.length < count * size) throw new Error("the pixels of this DICOM end early");
  const shared = set.get("52009229")?.[0];
  const each = set.get("52009230");
  const flat = (groups) => [...(groups?.values() ?? [])].filter(Array.isArray).flatMap(([first]) => [...(first ?? [])]);
  return Array.from({ length: count }, (_, i) => {
    const header = new Map([...set, ...flat(shared), ...flat(each?.[i])]);
    const numbers = (tag, otherwise) => {
      const list = header.has(tag) ? text(header.get(tag)).split("\\").map(Number) : otherwise;
      if (list?.some((x) => !Number.isFinite(x))) throw new Error(`element ${tag} of this DICOM is not a number`);
      return list;
    };
    const placed = header.has("00200032");
    return {
      ...format, little, pixels: pixels.subarray(i * size, (i + 1) * size), series: text(header.get("0020000e") ?? new Uint8Array()),
      isCt: text(header.get("00080060") ?? new Uint8Array()) === "CT", placed, position: numbers("00200032", [0, 0, i]),
      orientation: numbers("00200037", [1, 0, 0, 0, 1, 0]), spacing: numbers("00280030", [1, 1]), thickness: numbers("00180088", numbers("00180050", [1]))[0],
      slope: numbers("00281053", [1])[0], intercept: numbers("00281052", [0])[0],
    };
  });
}

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = ([a, b, c], [d, e, f]) => [b * f - c * e, c * d - a * f, a * e - b * d];

/** The frames of the longest series, in the order of their places, and the step from one to the next. */
function stacked(frames) {
  const series = Map.groupBy ? Map.groupBy(frames, (frame) => frame.series) : groupedBy(frames);
  const chosen = [...series.values()].sort((a, b) => b.length - a.length)[0];
  const [first] = chosen;
  const [across, down] = [first.orientation.slice(0, 3), first.orientation.slice(3)];
  const normal = cross(across, down);
  const alike = ({ rows, columns, orientation, spacing }) =>
    rows === first.rows && columns === first.columns && spacing.every((x, i) => Math.abs(x - first.spacing[i]) < 1e-4 * x) &&
    orientation.every((x, i) => Math.abs(x - first.orientation[i]) < 1e-3);
  if (!chosen.every(alike)) throw new Error("the slices of this series differ in size, spacing or orientation");
  const slices = chosen.map((frame) => ({ ...frame, height: dot(normal, frame.position) })).sort((a, b) => a.height - b.height);
  if (slices.length === 1) return { slices, across, down, step: normal.map((x) => x * first.thickness) };
  const gap = (slices.at(-1).height - slices[0].height) / (slices.length - 1);
  slices.forEach(({ height }, i) => {
    const off = Math.abs(height - slices[0].height - i * gap);
    if (!(off < 0.05 * gap)) throw new Error("the slices of this series are not evenly spaced: some are missing, or there are several at one place");
  });
  const way = slices.at(-1).position.map((x, axis) => (x - slices[0].position[axis]) / (slices.length - 1));
  return { slices, across, down, step: slices[0].placed ? way : normal.map((x) => x * first.thickness) };
}
function groupedBy(frames) {
  const groups = new Map();
  for (const frame of frames) groups.set(frame.series, [...(groups.get(frame.series) ?? []), frame]);
  return groups;
}

function valuesOf({ pixels, bits, stored, signed, little, slope, intercept }, out) {
  const view = new DataView(pixels.buffer, pixels.byteOffset);
  const unused = 32 - stored;
  for (let i = 0; i < out.length; ++i) {
    const raw = bits === 8 ? pixels[i] : view.getUint16(2 * i, little);
    out[i] = slope * (signed ? (raw << unused) >> unused : (raw << unused) >>> unused) + intercept;
  }
}

/** The smallest type of the core that has all values. */
function narrowed(values) {
  let [least, most, whole] = [Infinity, -Infinity, true];
  for (const v of values) {
    least = Math.min(least, v);
    most = Math.max(most, v);
    whole &&= Number.isInteger(v);
  }
  if (!whole) return values;
  if (least >= 0 && most <= 255) return Uint8Array.from(values);
  if (least >= -32768 && most <= 32767) return Int16Array.from(values);
  return least >= 0 && most <= 65535 ? Uint16Array.from(values) : values;
}

/** `files` are the bytes of each. Files that are no DICOM are passed over. */
export async function readDicom(files) {
  const frames = [];
  for (const bytes of files) if (isDicom(bytes)) frames.push(...framesOf(await parsed(bytes)));
  if (frames.length === 0) throw new Error("none of these files is DICOM with pixels");
  const { slices, across, down, step } = stacked(frames);
  const { rows, columns, spacing, position, isCt } = slices[0];
  const values = new Float32Array(rows * columns * slices.length);
  slices.forEach((slice, i) => valuesOf(slice, values.subarray(i * rows * columns, (i + 1) * rows * columns)));
  const axes = [across.map((x) => x * spacing[1]), down.map((x) => x * spacing[0]), step];
  return {
    samples: narrowed(values), geometry: geometryOf([columns, rows, slices.length], axes, position),
    marks: isCt ? { skin: -300, bone: 250 } : undefined, // [HU] docs/isovalue.md
  };
}
