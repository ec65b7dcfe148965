// The page in Chromium, for the tests: a server, a browser, and what the page says.
import assert from "node:assert/strict";
import { existsSync, mkdirSync, readFileSync, statSync } from "node:fs";
import { createServer } from "node:http";
import { createRequire } from "node:module";
import { extname, join } from "node:path";

export const folder = process.env.PALPATE_WEB;
export const pictures = join(folder, "..", "pictures");
const chromium = "/usr/bin/chromium";
export const volumes = join(folder, "..", "volumes"); // served below the package
const types = { ".html": "text/html", ".js": "text/javascript", ".css": "text/css", ".wasm": "application/wasm" };

/** A package of npm that scripts/deep/web installs, or null. */
export function installed(name) {
  try {
    return createRequire(join(folder, "..", "node", "index.js"))(name);
  } catch {
    return null;
  }
}

/** Lets time pass more slowly for a module, from now on, so that a busy machine keeps up with it. The same for a page and its
 * worker, and an hour later, as both begin after the server and no clock is below 0. */
const slowed = (slowness) => `{
  const begun = ${Date.now()}, real = performance.now.bind(performance);
  performance.now = () => 3.6e6 + begun + (performance.timeOrigin + real() - begun) / ${slowness} - performance.timeOrigin;
}
`;

/** Serves the package, isolated or not; counts the bytes without the volume. What has "held" in its query waits for release(). */
export async function served(isolated, slowness = 1) {
  let bytes = 0;
  let release;
  const held = new Promise((resolve) => (release = resolve));
  const clock = slowed(slowness);
  const server = createServer(async (request, answer) => {
    const { pathname: path, searchParams } = new URL(request.url, "http://localhost");
    if (searchParams.has("held")) await held;
    const file = path.startsWith("/volumes/") ? join(volumes, path.slice(8)) : join(folder, path);
    if (!existsSync(file) || !statSync(file).isFile()) return answer.writeHead(404).end();
    const isProgram = slowness > 1 && /\/(worker|page)\.js$/.test(path);
    const data = Buffer.concat([Buffer.from(isProgram ? clock : ""), readFileSync(file)]);
    if (extname(file) !== ".nrrd") bytes += data.length;
    answer.writeHead(200, {
      "content-type": types[extname(file)] ?? "application/octet-stream",
      ...(isolated ? { "cross-origin-opener-policy": "same-origin", "cross-origin-embedder-policy": "require-corp" } : {}),
    });
    answer.end(data);
  });
  await new Promise((listens) => server.listen(0, "127.0.0.1", listens));
  return { server, address: `http://127.0.0.1:${server.address().port}/page/index.html`, bytes: () => bytes, release };
}

/** Nothing has a limit of its own but the test. */
export const launched = () => installed("puppeteer-core").launch({
  executablePath: chromium,
  protocolTimeout: 0,
  args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
});

export async function newPage(browser) {
  const page = await browser.newPage();
  page.setDefaultTimeout(0);
  return page;
}

/** `expected` are parts of messages on the console that are no errors of the page. `slowness`: of the page's clock. `prepare`
 * sees the page before it loads. */
export async function opened(work, { expected = [], slowness = 1, prepare = () => {} } = {}) {
  const site = await served(true, slowness);
  const browser = await launched();
  try {
    const page = await newPage(browser);
    const errors = [];
    page.on("pageerror", (error) => errors.push(error.message));
    page.on("console", (message) => message.type() === "error" && errors.push(message.text()));
    await page.setViewport({ width: 900, height: 640 });
    await prepare(page);
    await page.goto(site.address);
    await page.waitForFunction(() => Number(document.body.dataset.surface) > 0);
    await work(page, site);
    assert.deepEqual(errors.filter((error) => !expected.some((part) => error.includes(part))), []);
  } finally {
    await browser.close();
    site.server.close();
  }
}

const waits = (page, id, { source }) =>
  page.waitForFunction((at, text) => new RegExp(text).test(document.getElementById(at).textContent), {}, id, source);
export const says = (page, pattern) => waits(page, "state", pattern);
/** To those who do not see the page. */
export const announces = (page, pattern) => waits(page, "said", pattern);
/** Moves the mouse over the forehead, wherever the page has been scrolled to. */
export async function hover(page) {
  const scene = await page.$("#scene");
  await scene.scrollIntoView();
  const { x, y, width, height } = await scene.boundingBox();
  await page.mouse.move(x + width / 2, y + height * 0.4);
}
mkdirSync(pictures, { recursive: true });
export const picture = (page, name) => page.screenshot({ path: join(pictures, `${name}.png`) });

export const skip = (!existsSync(chromium) && "there is no Chromium") || (!installed("puppeteer-core") && "puppeteer-core is not installed (scripts/deep/web)");
