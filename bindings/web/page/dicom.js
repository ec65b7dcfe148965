// Reads the slices of a DICOM series, or a file of several frames, into samples and a geometry in LPS. What is not
// known to be read as the native program reads it is refused; so are compressed pixels, which browsers cannot unpack.
import { inflated } from "../inflated.js";
import { countOf, geometryOf, isDicom, refuse } from "./files.js";

const syntaxes = {
  "1.2.840.10008.1.2": {}, "1.2.840.10008.1.2.1": { explicit: true }, "1.2.840.10008.1.2.2": { explicit: true, big: true },
  "1.2.840.10008.1.2.1.99": { explicit: true, deflated: true },
};
const longForms = new Set(["OB", "OD", "OF", "OL", "OV", "OW", "SQ", "UC", "UN", "UR", "UT", "SV", "UV"]);
const open = 0xffffffff; // a length that is not told
const again = "copy or export it again";

const tags = {
  storage: "00080016", imageType: "00080008", modality: "00080060", description: "0008103e", seriesNumber: "00200011", series: "0020000e",
  echoTime: "00180081", echo: "00180086", bValue: "00189087", between: "00180088", thickness: "00180050", position: "00200032", orientation: "00200037",
  samples: "00280002", colours: "00280004", frames: "00280008", rows: "00280010", columns: "00280011", spacing: "00280030", allocated: "00280100",
  aspect: "00280034", stack: "00209056", frameType: "00089007", frameEcho: "00189082", stored: "00280101", highBit: "00280102", signed: "00280103", intercept: "00281052", slope: "00281053", units: "00281054", pixels: "7fe00010",
  shared: "52009229", each: "52009230", patient: "00100020", study: "0020000d", space: "00200052",
};
/** Positions can be compared only within these. */
const identities = ["patient", "study", "space"];
/** Functional groups of frames, and what of them is taken. */
const macros = {
  "00289110": [tags.spacing, tags.between, tags.thickness], "00209113": [tags.position], "00209116": [tags.orientation],
  "00289145": [tags.intercept, tags.slope, tags.units], "00209111": [tags.stack], "00189114": [tags.frameEcho], "00189117": [tags.bValue],
  "00189226": [tags.frameType], "00189329": [tags.frameType], "00189732": [tags.frameType], "00189504": [tags.frameType], "00409092": [tags.frameType], "00189806": [tags.frameType],
};
const unread = {
  "00283000": "a table of values (Modality LUT)", "3004000e": "a DoseGridScaling", "7fe00008": "samples of float32", "7fe00009": "samples of float64",
  "00620002": "segments", "00480006": "an image of tiles",
};
/** All storage classes but those of images: reports, plans, structures, presentations, raw data, the index of a folder. */
const withoutImage = /^(?!1\.2\.840\.10008\.5\.1\.4\.1\.1\.([1-7]|12|13|14|20|30|40|128|130|66\.4|66\.7|77\.1)(\.|$))\d|\.77\.1\.5\.3$/;
const spectra = "1.2.840.10008.5.1.4.1.1.4.2";

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
    if (depth > 16) refuse("its sequences are nested too deep", again);
    const set = new Map();
    while (this.at < end) {
      if (depth === 0 && this.bytes[this.at] === 0 && !this.bytes.subarray(this.at).some((byte) => byte !== 0)) break; // padding
      const tag = this.tag();
      if (tag === "fffee00d") {
        this.at += 4;
        break;
      }
      if (set.has(tag)) refuse(`element ${tag} is there twice`, again);
      let kind = "";
      if (this.explicit) {
        kind = String.fromCharCode(this.bytes[this.at], this.bytes[this.at + 1]);
        if (!/^[A-Z]{2}$/.test(kind)) refuse(`element ${tag} is of no known type`, again);
        this.at += 2;
      }
      if (tag === tags.pixels) this.pixelKind = kind;
      let size;
      if (this.explicit && !longForms.has(kind)) size = this.short();
      else {
        if (this.explicit) this.at += 2;
        size = this.long();
      }
      if (size !== open && this.at + size > end) refuse(`element ${tag} reaches beyond its end`, again);
      if (kind === "SQ" || size === open || tag === tags.shared || tag === tags.each) {
        if (tag === tags.pixels) refuse("compressed pixels are not read in the browser");
        set.set(tag, this.items(size === open ? end : this.at + size, depth, kind));
      } else if (this.isSequence(kind, size, tag)) set.set(tag, this.items(this.at + size, depth, kind));
      else {
        set.set(tag, this.bytes.subarray(this.at, this.at + size));
        this.at += size;
      }
    }
    return set;
  }
  /** Implicit syntax does not tell sequences from values: they begin with the tag of an item. */
  isSequence(kind, size, tag) {
    return kind === "" && tag !== tags.pixels && size >= 8 && this.view.getUint32(this.at, true) === 0xe000fffe;
  }
  items(end, depth, kind) {
    const { explicit } = this;
    this.explicit &&= kind !== "UN"; // those of unknown type are implicit (PS3.5, 6.2.2)
    const list = [];
    while (this.at < end) {
      const tag = this.tag();
      const size = this.long();
      if (tag === "fffee0dd") break;
      if (tag !== "fffee000") refuse(`a sequence has element ${tag} in place of an item`, again);
      if (size !== open && this.at + size > end) refuse("an item reaches beyond its end", again);
      list.push(this.elements(size === open ? end : this.at + size, depth + 1));
    }
    this.explicit = explicit;
    return list;
  }
}

async function parsed(bytes) {
  let end = 132;
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  while (end + 8 <= bytes.length && view.getUint16(end, true) === 2) {
    const isLong = longForms.has(String.fromCharCode(bytes[end + 4], bytes[end + 5]));
    end += isLong ? 12 + view.getUint32(end + 8, true) : 8 + view.getUint16(end + 6, true);
  }
  const head = new Reader(bytes.subarray(132, end), { explicit: true }).elements(end - 132);
  const name = new Header(head).text("00020010");
  const syntax = syntaxes[name] ?? refuse(`DICOM of transfer syntax ${name} is not read in the browser`);
  const body = syntax.deflated ? await inflated(bytes.subarray(end), "deflate-raw") : bytes.subarray(end);
  const reader = new Reader(body, syntax);
  return { header: new Header(reader.elements(body.length), reader.little), pixelKind: reader.pixelKind };
}

/** Values of elements. Empty ones are absent. */
class Header {
  constructor(set, little = true) {
    Object.assign(this, { set, little });
  }
  has(tag) {
    return this.set.get(tag)?.length > 0;
  }
  text(tag) {
    const value = this.set.get(tag) ?? [];
    return value instanceof Uint8Array ? new TextDecoder().decode(value).replace(/[\0 ]+$/, "").trim() : "";
  }
  numbers(tag, count) {
    const told = this.text(tag);
    if (told === "") return undefined;
    const list = told.split("\\").map((one) => one.trim());
    if (!list.every((one) => /^[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?$/i.test(one))) refuse(`element ${tag} is not a number ('${told}')`, "correct its header");
    return list.length === count ? list.map(Number) : refuse(`element ${tag} has ${list.length} numbers in place of ${count}`, "correct its header");
  }
  whole(tag, otherwise) {
    if (!this.has(tag)) return otherwise;
    const value = this.set.get(tag);
    if (value.length !== 2) refuse(`element ${tag} has ${value.length} bytes in place of 2`, again);
    return new DataView(value.buffer, value.byteOffset).getUint16(0, this.little);
  }
  items(tag) {
    const value = this.set.get(tag);
    return Array.isArray(value) ? value : [];
  }
}

/** Siemens and United Imaging pack a whole volume into one flat image. Enhanced files of Siemens keep the mark. */
function isMosaic(header, count) {
  if (count > 1) return false;
  if (/MOSAIC|VFRAME/.test(header.text(tags.imageType))) return true;
  if (header.text("00190010") === "SIEMENS MR HEADER" && header.set.get("0019100a")?.length === 2) return header.whole("0019100a") > 1;
  return header.text("00650010") === "Image Private Header" && Number(header.text("00651050")) > 1;
}

/** How pixels are stored: one value of 8 or 16 bits each. */
function formatOf(header, pixelKind) {
  for (const [tag, what] of Object.entries(unread)) if (header.set.has(tag)) refuse(`${what} (element ${tag}) is not read in the browser`);
  const colours = header.text(tags.colours);
  if (header.whole(tags.samples, 1) !== 1 || !["", "MONOCHROME1", "MONOCHROME2"].includes(colours)) refuse(`DICOM in colours (${colours}) is not read`, "give a series with one value per sample");
  const bits = header.whole(tags.allocated);
  const format = { rows: header.whole(tags.rows), columns: header.whole(tags.columns), bits, stored: header.whole(tags.stored, bits), signed: header.whole(tags.signed, 0) === 1 };
  const { rows, columns, stored } = format;
  if (bits !== 8 && bits !== 16) refuse(`DICOM of ${bits} bits is not read`);
  const high = header.whole(tags.highBit, stored - 1);
  if (!(stored >= 1 && stored <= bits && high === stored - 1)) refuse(`samples of ${stored} bits up to bit ${high} (HighBit) of ${bits} are not read`);
  if (header.whole(tags.signed, 0) > 1) refuse("its PixelRepresentation is neither 0 nor 1", "correct its header");
  if (!header.little && bits === 8 && pixelKind !== "OB") refuse("8 bits in big-endian words (OW) are not read");
  return { ...format, little: header.little, size: (countOf([rows, columns]) * bits) / 8 };
}

function framesIn(header) {
  const told = (header.text(tags.frames) || "1").replace(/^\+?0+$/, "1"); // pydicom reads 0 as 1, too
  return /^\+?[1-9]\d{0,6}$/.test(told) ? Number(told) : refuse(`it has '${told}' frames, which is not possible`, again);
}

/** The header that holds for each frame. */
function headersOf(header, count) {
  const [shared] = header.items(tags.shared);
  const told = header.items(tags.each);
  const each = told.length === 0 && count === 1 ? [new Map()] : told;
  if (each.length === 0) refuse(`its ${count} frames do not say where they lie: they may be moments (FrameIncrementPointer), or slices by SliceVector`);
  if (each.length !== count) refuse(`it has ${count} frames, and describes ${each.length}`, again);
  return each.map((group) => {
    const set = new Map(header.set);
    for (const [macro, taken] of Object.entries(macros)) {
      const [inside] = group.get(macro) ?? shared?.get(macro) ?? [];
      for (const tag of taken) if (inside?.get?.(tag)?.length > 0) set.set(tag, inside.get(tag));
    }
    return new Header(set, header.little);
  });
}

function unitVectors(list) {
  if (!list) return undefined;
  const [across, down] = [list.slice(0, 3), list.slice(3)].map((v) => v.map((x) => x / Math.hypot(...v)));
  const isUnit = [list.slice(0, 3), list.slice(3)].every((v) => Math.abs(Math.hypot(...v) - 1) < 1e-3);
  if (!isUnit || !(Math.abs(dot(across, down)) < 1e-3)) refuse("its row and column directions are no unit vectors at right angles", "correct its header");
  const along = dot(across, down);
  const rest = down.map((x, i) => x - along * across[i]);
  return [across, rest.map((x) => x / Math.hypot(...rest))];
}

/** The frames of a file. */
function framesOf({ header, pixelKind }) {
  const storage = header.text(tags.storage);
  if (storage === spectra || (!header.set.has(tags.rows) && withoutImage.test(storage))) return [];
  if (!header.has(tags.rows) || !header.has(tags.columns)) refuse("it gives no size of its image: it is cut off or damaged", again);
  if (!header.set.has(tags.pixels)) refuse("it has no pixels, but says how large its image is: it is cut off", `${again}, or leave it out`);
  const format = formatOf(header, pixelKind);
  const count = framesIn(header);
  if (isMosaic(header, count)) refuse("a MOSAIC of slices is not read", "convert it to NIfTI first, for example with dcm2niix");
  const pixels = header.set.get(tags.pixels);
  const expected = countOf([count, format.size]);
  if (pixels.length !== expected && pixels.length !== expected + (expected % 2)) refuse(`it has ${pixels.length} bytes of pixels in place of ${expected}`, again);
  return headersOf(header, count).map((one, i) => {
    const spacing = one.numbers(tags.spacing, 2);
    if (!spacing && (one.has("00181164") || one.has("00182010") || one.items("00186011").length > 0)) {
      refuse("its pixel spacing is that at the detector (ImagerPixelSpacing), of a scan or of regions of ultrasound");
    }
    if (spacing?.some((s) => !(s > 0))) refuse(`a PixelSpacing of ${spacing.join(" x ")} mm is not possible`, "correct its header");
    const between = one.numbers(tags.between, 1)?.[0];
    return {
      ...format, pixels: pixels.subarray(i * format.size, (i + 1) * format.size), spacing, position: one.numbers(tags.position, 3),
      orientation: unitVectors(one.numbers(tags.orientation, 6)), thickness: Math.abs(between) || one.numbers(tags.thickness, 1)?.[0],
      slope: one.numbers(tags.slope, 1)?.[0], intercept: one.numbers(tags.intercept, 1)?.[0] ?? 0, modality: one.text(tags.modality),
      isRescaled: one.has(tags.slope) && one.has(tags.intercept), units: one.text(tags.units),
      aspect: one.numbers(tags.aspect, 2), isInverse: one.text(tags.colours) === "MONOCHROME1",
      label: one.text(tags.description) || one.text(tags.seriesNumber) || one.text(tags.series),
      identities: identities.map((name) => one.text(tags[name])),
      key: [
        ...["series", "imageType", "echoTime", "echo", "modality", "stack", "frameType"].map((name) => one.text(tags[name])),
        String(one.set.get(tags.bValue)), String(one.set.get(tags.frameEcho)), format.rows, format.columns,
      ].join("|"),
    };
  });
}

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = ([a, b, c], [d, e, f]) => [b * f - c * e, c * d - a * f, a * e - b * d];

/** All frames, if they are of one series. */
function oneSeries(frames) {
  // An anonymiser may give each file an identity of its own. It then tells nothing apart.
  const isUnique = identities.map((_, i) => {
    const own = frames.map((frame) => frame.identities[i]);
    return new Set(own).size === own.length && own.length > 2;
  });
  const keyOf = ({ key, identities: own }) => [key, ...own.filter((_, i) => !isUnique[i])].join("|");
  const groups = new Map();
  for (const frame of frames) groups.set(keyOf(frame), [...(groups.get(keyOf(frame)) ?? []), frame]);
  if (groups.size === 1) return;
  const list = [...groups.values()].map(([{ label, key, rows, columns }, ...others]) => `${1 + others.length} of ${columns} x ${rows} '${label}' ${key.split("|")[1].replaceAll("\\", " ")}`);
  refuse(`there are ${groups.size} series in it (${list.slice(0, 8).join("; ")})`, "choose the files of one");
}

/** Between rows and between columns [mm]. */
const spacingOf = ({ spacing, aspect: [high, wide] = [1, 1] }) => spacing ?? [high / wide, 1];

/** The frames in the order of their places, and the columns of the grid's directions. */
function stacked(frames, notes) {
  const [first] = frames;
  const note = (text, is) => is && notes.push(text);
  if (first.aspect?.some((x) => !(x > 0))) refuse("its PixelAspectRatio is not possible", "correct its header");
  note("it gives no pixel spacing: 1 mm was taken", !first.spacing && !first.aspect);
  note("it gives only the shape of its pixels: they were taken as 1 mm wide", !first.spacing && first.aspect);
  note("its MONOCHROME1 says that greater values are shown darker: values were taken as they are stored", frames.some(({ isInverse }) => isInverse));
  const lacking = frames.filter(({ isRescaled }) => !isRescaled).length;
  note(`${lacking} of its ${frames.length} slices give no slope or no intercept, and others do: do not trust what is felt there`,
    lacking > 0 && frames.some(({ isRescaled, slope, intercept }) => isRescaled && (slope !== 1 || intercept !== 0)));
  note("its RescaleSlope is 0, which makes no sense: 1 was taken", frames.some(({ slope }) => slope === 0));
  const near = (a, b, part) => !a === !b && (a ?? []).every((x, i) => Math.abs(x - b[i]) <= part);
  const alike = ({ orientation, spacing }) => near(orientation?.flat(), first.orientation?.flat(), 1e-3) && near(spacing, first.spacing, 1e-3 * Math.max(...(first.spacing ?? [1])));
  if (!frames.every(alike)) refuse("the slices of this series differ in spacing or orientation");
  const isDirected = frames.every(({ orientation }) => orientation);
  const [across, down] = isDirected ? first.orientation : [[1, 0, 0], [0, 1, 0]];
  const normal = cross(across, down);
  if (frames.length === 1) {
    note("it gives no distance between slices: 1 mm was taken", !(first.thickness > 0));
    note("it does not say how it lies in the body", !isDirected);
    return { slices: frames, directions: [across, down, normal], gap: first.thickness > 0 ? first.thickness : 1 };
  }
  if (!isDirected || !frames.every(({ position }) => position)) refuse("the slices of this series do not say where they lie (ImagePositionPatient, ImageOrientationPatient)");
  const slices = frames.map((frame) => ({ ...frame, height: dot(normal, frame.position) })).sort((a, b) => a.height - b.height);
  const gap = (slices.at(-1).height - slices[0].height) / (slices.length - 1);
  const gaps = slices.slice(1).map(({ height }, i) => height - slices[i].height);
  const middle = [...gaps].sort((a, b) => a - b)[gaps.length >> 1];
  const tolerance = Math.max(Math.min(0.01, 0.1 * middle), 0.02 * middle);
  const [dy, dx] = spacingOf(first);
  const samePlace = 0.05 * Math.min(1, first.spacing ? Math.min(dx, dy) : 0.1); // [mm] nearer slices are moments of one
  // Gaps that differ by little may still add up: it is the places that have to be even.
  const isEven = slices.every(({ height }, i) => Math.abs(height - slices[0].height - i * gap) <= tolerance);
  if (!isEven || !gaps.every((one) => one > samePlace)) refuse("the slices of this series are not evenly spaced: some are missing, or there are several at one place");
  const isShifted = ({ position }) => {
    const from = position.map((x, i) => x - slices[0].position[i]);
    return Math.abs(dot(across, from)) > 0.05 * dx || Math.abs(dot(down, from)) > 0.05 * dy;
  };
  if (slices.some(isShifted)) refuse("the slices of this series are shifted against each other (gantry tilt)");
  return { slices, directions: [across, down, normal], gap };
}

function valuesOf({ pixels, bits, stored, signed, little, slope, intercept }, out) {
  const view = new DataView(pixels.buffer, pixels.byteOffset);
  const unused = 32 - stored;
  const factor = slope || 1;
  for (let i = 0; i < out.length; ++i) {
    const raw = bits === 8 ? pixels[i] : view.getUint16(2 * i, little);
    out[i] = factor * (signed ? (raw << unused) >> unused : (raw << unused) >>> unused) + intercept;
  }
}

/** The samples in the type that the native program takes. */
function typed(values, slices) {
  const [{ bits, signed }] = slices;
  const isStored = slices.every((one) => (one.slope || 1) === 1 && one.intercept === 0 && one.bits === bits && one.signed === signed);
  if (isStored) return (signed ? Int16Array : bits === 8 ? Uint8Array : Uint16Array).from(values);
  const lies = (least, most) => values.every((v) => Number.isInteger(v) && v >= least && v <= most);
  return lies(-32768, 32767) ? Int16Array.from(values) : lies(0, 65535) ? Uint16Array.from(values) : values;
}

/** A file that is no DICOM, though slices have such names: to pass over it would hide a gap. */
function checkOthers(files) {
  const numberless = (path) => path.replaceAll(/\d+(?=[^/]*$)/g, "#");
  const isBare = (path) => /(^|\/)[^/.]*\d[^/.]*$/.test(path);
  const slices = files.filter(({ bytes }) => isDicom(bytes)).map(({ path }) => path);
  const names = new Set(slices.filter((path) => !/(^|\/)DICOMDIR$/.test(path)).map(numberless));
  for (const { path, bytes } of files) {
    const isLost = names.has(numberless(path)) || (bytes.length === 0 && isBare(path) && slices.some((one) => !one.split("/").at(-1).includes(".")));
    if (!isDicom(bytes) && isLost) refuse(`${path} is ${bytes.length === 0 ? "empty" : "no DICOM file"}, though slices have such names`, "copy it again, or take it away");
  }
}

/** `files` have a path and bytes each. Returns samples, geometry, marks, whether it is of a body, and notes. */
export async function readDicom(files) {
  const frames = [];
  const notes = [];
  checkOthers(files);
  for (const { path, bytes } of files) {
    const name = path.split("/").at(-1);
    if (!isDicom(bytes)) {
      notes.push(`${name} is no DICOM and was passed over`);
      continue;
    }
    try {
      frames.push(...framesOf(await parsed(bytes)));
    } catch (error) {
      throw new Error(`${name}: ${error instanceof RangeError ? `it is cut off or damaged: ${again}` : error.message}`);
    }
  }
  if (frames.length === 0) refuse("none of these files is NRRD, MetaImage, NIfTI, or DICOM with pixels");
  oneSeries(frames);
  const { slices, directions, gap } = stacked(frames, notes);
  const { rows, columns, orientation, position: place, modality, label } = slices[0];
  const spacing = spacingOf(slices[0]);
  const isHounsfield = modality === "CT" && slices.every((one) => one.isRescaled && ["", "HU"].includes(one.units));
  if (label) notes.push(`series '${label}'`);
  const values = new Float32Array(countOf([columns, rows, slices.length]));
  slices.forEach((slice, i) => valuesOf(slice, values.subarray(i * rows * columns, (i + 1) * rows * columns)));
  const axes = [spacing[1], spacing[0], gap].map((step, a) => directions[a].map((x) => x * step));
  return {
    samples: typed(values, slices), geometry: geometryOf([columns, rows, slices.length], axes, (orientation && place) ?? [0, 0, 0]), oriented: orientation !== undefined, notes,
    marks: isHounsfield ? { skin: -300, bone: 250 } : undefined, // [HU] docs/isovalue.md
  };
}
