// What a visitor opens: files chosen or dropped, a folder, or an address. Finds out which format it is. Readers that
// the first touch does not need are loaded later.
import { isDicom, readVolume } from "./files.js";

const readDicom = async (files) => (await import("./dicom.js")).readDicom(files);
const readZarr = async (get) => (await import("./zarr.js")).readZarr(get);

const bytesOf = async (file) => new Uint8Array(await file.arrayBuffer());
const isZarr = /(^|\/)(zarr\.json|\.zattrs|\.zarray)$/;

/** `files` have a path and a file each. Returns samples, geometry, a name, and marks if levels are known. */
export async function readFiles(files) {
  if (files.length === 0) throw new Error("there is no file in it");
  const root = files.map(({ path }) => path).filter((path) => isZarr.test(path)).sort((a, b) => a.length - b.length)[0];
  const name = files[0].path.split("/")[0];
  if (root !== undefined) {
    const folder = root.replace(isZarr, "$1");
    const byPath = new Map(files.map(({ path, file }) => [path, file]));
    const get = async (path) => (byPath.has(folder + path) ? bytesOf(byPath.get(folder + path)) : null);
    return { name, ...(await readZarr(get)) };
  }
  const first = await bytesOf(files[0].file);
  if (files.length === 1 && !isDicom(first)) return { name, ...(await readVolume(first.buffer)) };
  return { name, ...(await readDicom(await Promise.all(files.map(({ file }) => bytesOf(file))))) };
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

async function fetched(address) {
  const answer = await fetch(address).catch(() => {
    throw new Error(`${address} cannot be reached, or does not permit other pages to read it (CORS)`);
  });
  if (answer.status === 404 || answer.status === 403) return null; // stores answer so for what is not there
  if (!answer.ok) throw new Error(`${address}: ${answer.status} ${answer.statusText}`);
  return new Uint8Array(await answer.arrayBuffer());
}

/** An OME-Zarr, or a file, on a server. */
export async function readAddress(address) {
  const url = new URL(address, location.href);
  const path = url.pathname.replace(/\/(zarr\.json|\.zattrs|\.zarray)?$/, "");
  const name = path.split("/").at(-1);
  if (!/\.(nrrd|nii|nii\.gz|dcm)$/i.test(path)) {
    const get = (object) => fetched(new URL(`${path}/${object}${url.search}`, url));
    return { name, ...(await readZarr(get)) };
  }
  const bytes = await fetched(url);
  if (!bytes) throw new Error(`${url}: there is no such file`);
  return { name, ...(isDicom(bytes) ? await readDicom([bytes]) : await readVolume(bytes.buffer)) };
}
