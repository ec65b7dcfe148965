// Opens files that were chosen or dropped, a folder, or an address, and finds out which format it is. `load` gives a
// Palpate, whose readers are the native ones. Readers that the first touch does not need are loaded later.
import { isDicom, refuse } from "./files.js";

const readDicom = async (files) => (await import("./dicom.js")).readDicom(files);
const readZarr = async (get) => (await import("./zarr.js")).readZarr(get);

const bytesOf = async (file) => new Uint8Array(await file.arrayBuffer());
const isHidden = /(^|\/)(\.[^/]*|Thumbs\.db|desktop\.ini)$/i; // left by systems
const isVolume = /\.(nrrd|nhdr|mha|mhd|mgz|vtk|(mgh|mrc|map|rec|ccp4|nii|hdr)(\.gz)?)$/i;
/** Named as DICOM is, or beginning with its groups, without a preamble. */
const isBare = (name, bytes) => /\.(dcm|ima)$/i.test(name) || ([2, 8].includes(bytes[0]) && bytes[1] === 0 && bytes[3] === 0 && /^[A-Z]{2}$/.test(String.fromCharCode(bytes[4], bytes[5])));

/** With a Palpate of its own, whose memory goes with it. */
async function readVolume(load, files, path) {
  const { volume, ...about } = await (await load()).read(files, path);
  const { size, spacing, origin, direction } = volume;
  return { samples: volume.samples(), geometry: { size, spacing, origin, direction }, ...about };
}

const isZarr = /(^|\/)(zarr\.json|\.zattrs|\.zarray)$/;

/** Calls `use` or `fail` with what a function reads. Of several that read at the same time, the last one that began counts. */
export function lastAsked(use, fail) {
  let newest = 0;
  return async (read) => {
    const mine = ++newest;
    try {
      const data = await read();
      if (mine === newest) use(data);
    } catch (error) {
      if (mine === newest) fail(error);
    }
  };
}

/** `files` have a path and a file each. Returns samples, geometry, a name, and marks if levels are known. */
export async function readFiles(files, load) {
  if (files.length === 0) refuse("there is no file in it", "choose another");
  const root = files.map(({ path }) => path).filter((path) => isZarr.test(path)).sort((a, b) => a.length - b.length)[0];
  const name = files[0].path.split("/")[0];
  if (root !== undefined) {
    const folder = root.replace(isZarr, "$1");
    const byPath = new Map(files.map(({ path, file }) => [path, file]));
    const get = async (path) => (byPath.has(folder + path) ? bytesOf(byPath.get(folder + path)) : null);
    return { name, ...(await readZarr(get)) };
  }
  const all = await Promise.all(files.filter(({ path }) => !isHidden.test(path)).map(async ({ path, file }) => ({ path, bytes: await bytesOf(file) })));
  for (const { path, bytes } of all) if (!isDicom(bytes) && isBare(path, bytes)) refuse(`${path} has not the letters DICM of a DICOM file`);
  const dicoms = all.filter(({ bytes }) => isDicom(bytes));
  const volumes = all.filter((one) => isVolume.test(one.path) && !dicoms.includes(one));
  if (volumes.length > 1 || (volumes.length === 1 && dicoms.length > 0)) refuse(`there are several volumes in it: ${[...volumes, ...dicoms].slice(0, 8).map((one) => one.path).join(", ")}`, "choose one");
  const single = volumes[0] ?? (all.length === 1 && dicoms.length === 0 ? all[0] : null);
  return { name, ...(single ? await readVolume(load, all, single.path) : await readDicom(all)) };
}

/** Everything in what was dropped, with its path. */
export async function droppedFiles(items) {
  const found = [];
  const walk = async (entry) => {
    if (entry.isFile) return found.push({ path: entry.fullPath.slice(1), file: await new Promise((done, fail) => entry.file(done, fail)) });
    const reader = entry.createReader();
    for (;;) {
      const some = await new Promise((done, fail) => reader.readEntries(done, fail));
      if (some.length === 0) return undefined;
      for (const one of some) await walk(one);
    }
  };
  const entries = [...items].map((item) => item.webkitGetAsEntry()).filter(Boolean); // before the first await
  for (const entry of entries) await walk(entry);
  return found;
}

/** Chosen with an input, files or a folder. */
export const chosenFiles = (list) => [...list].map((file) => ({ path: file.webkitRelativePath || file.name, file }));

/** An address without what may be secret. */
const shownOf = ({ origin, pathname }) => origin + pathname;

async function fetched(url, absent) {
  const answer = await fetch(url).catch(() => {
    throw new Error(`${shownOf(url)} cannot be reached, or does not permit other pages to read it (CORS)`);
  });
  if (absent.includes(answer.status)) return null;
  if (!answer.ok) throw new Error(`${shownOf(url)}: ${answer.status} ${answer.statusText}`);
  return new Uint8Array(await answer.arrayBuffer());
}

/** An OME-Zarr, or a file, on a server. */
export async function readAddress(address, load) {
  const url = new URL(address, location.href);
  if (url.username || url.password) refuse("an address with a user or password is not opened", "download it, and open the file");
  const path = url.pathname.replace(/\/(zarr\.json|\.zattrs|\.zarray)?$/, "");
  const name = path.split("/").at(-1);
  if (!isVolume.test(path) && !/\.dcm$/i.test(path)) {
    // Stores answer 403 for metadata that are not there; a chunk that is forbidden is not empty.
    const get = (object, isMetadata) => fetched(new URL(`${path}/${object}${url.search}`, url), isMetadata ? [403, 404] : [404]);
    return { name, ...(await readZarr(get)) };
  }
  const bytes = await fetched(url, [404]);
  if (!bytes) throw new Error(`${shownOf(url)}: there is no such file`);
  const files = [{ path: name, bytes }];
  return { name, ...(isDicom(bytes) ? await readDicom(files) : await readVolume(load, files, name)) };
}
