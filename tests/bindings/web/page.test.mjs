// The page in Chromium: a mouse touches, presses through, drills, undoes and records. Pictures are kept for people.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { existsSync, mkdirSync, readFileSync, rmSync, statSync, writeFileSync } from "node:fs";
import { createServer } from "node:http";
import { createRequire } from "node:module";
import { extname, join } from "node:path";
import test from "node:test";

const folder = process.env.PALPATE_WEB;
const pictures = join(folder, "..", "pictures");
const chromium = "/usr/bin/chromium";
const volumes = join(folder, "..", "volumes"); // served below the package
const types = { ".html": "text/html", ".js": "text/javascript", ".css": "text/css", ".wasm": "application/wasm" };

/** puppeteer-core beside the package (scripts/deep/web installs it), or null. */
function puppeteer() {
  try {
    return createRequire(join(folder, "..", "node", "index.js"))("puppeteer-core");
  } catch {
    return null;
  }
}

/** Serves the package, isolated or not; counts the bytes without the volume. */
async function served(isolated) {
  let bytes = 0;
  const server = createServer((request, answer) => {
    const path = new URL(request.url, "http://localhost").pathname;
    const file = path.startsWith("/volumes/") ? join(volumes, path.slice(8)) : join(folder, path);
    if (!existsSync(file) || !statSync(file).isFile()) return answer.writeHead(404).end();
    const data = readFileSync(file);
    if (extname(file) !== ".nrrd") bytes += data.length;
    answer.writeHead(200, {
      "content-type": types[extname(file)] ?? "application/octet-stream",
      ...(isolated ? { "cross-origin-opener-policy": "same-origin", "cross-origin-embedder-policy": "require-corp" } : {}),
    });
    answer.end(data);
  });
  await new Promise((listens) => server.listen(0, "127.0.0.1", listens));
  return { server, address: `http://127.0.0.1:${server.address().port}/page/index.html`, bytes: () => bytes };
}

const launched = () => puppeteer().launch({
  executablePath: chromium,
  args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
});

/** `expected` are parts of messages on the console that are no errors of the page. */
async function opened(work, expected = []) {
  const site = await served(true);
  const browser = await launched();
  try {
    const page = await browser.newPage();
    const errors = [];
    page.on("pageerror", (error) => errors.push(error.message));
    page.on("console", (message) => message.type() === "error" && errors.push(message.text()));
    await page.setViewport({ width: 900, height: 640 });
    await page.goto(site.address);
    await page.waitForFunction(() => Number(document.body.dataset.surface) > 0, { timeout: 150000 });
    await work(page, site);
    assert.deepEqual(errors.filter((error) => !expected.some((part) => error.includes(part))), []);
  } finally {
    await browser.close();
    site.server.close();
  }
}

const says = (page, pattern) =>
  page.waitForFunction((text) => new RegExp(text).test(document.getElementById("state").textContent), { timeout: 150000 }, pattern.source);
const picture = (page, name) => page.screenshot({ path: join(pictures, `${name}.png`) });

const skip = (!existsSync(chromium) && "there is no Chromium") || (!puppeteer() && "puppeteer-core is not installed (scripts/deep/web)");

test("the head is touched, pressed through, drilled and recorded", { skip, timeout: 1500000 }, async () => {
  mkdirSync(pictures, { recursive: true });
  await opened(async (page, site) => {
    assert.ok(site.bytes() < 1e6, `${site.bytes()} bytes`);
    await picture(page, "loaded");
    const box = await (await page.$("#scene")).boundingBox();
    const [x, y] = [box.x + box.width / 2, box.y + box.height * 0.4];
    await page.click("#record");
    await page.mouse.move(x, y);
    await says(page, /press to touch/);
    await page.mouse.down();
    await says(page, /In contact: .* at level 35/);
    await picture(page, "touch");
    await page.mouse.up();
    await says(page, /press to touch/);

    await page.click("#through");
    await page.mouse.move(x, y);
    await page.mouse.down();
    await says(page, /at level ([4-9]\d|1\d\d)/);
    await picture(page, "through");
    await page.mouse.up();
    await page.click("#through");

    await page.click("#drill");
    const surfaces = () => page.evaluate(() => Number(document.body.dataset.surface));
    const more = () => page.waitForFunction((n) => Number(document.body.dataset.surface) > n, { timeout: 150000 }, before);
    await page.mouse.move(x, y);
    let before = await surfaces();
    await page.mouse.down();
    await more(); // while the hand presses
    await page.mouse.up();
    await says(page, /press to touch/);
    await picture(page, "drilled");
    before = await surfaces();
    await page.click("#undo");
    await more();
    await picture(page, "undone");

    await page.click("#record");
    await page.waitForSelector("#save:not([hidden])");
    const text = await page.evaluate(async () => (await fetch(document.getElementById("save").href)).text());
    const file = join(pictures, "visible_human_head.csv");
    writeFileSync(file, text);
    assert.match(text, /# end \{/);
    if (process.env.PALPATE) {
      const volume = join(process.env.PALPATE_SOURCE, "data", "visible_human_head.nrrd");
      execFileSync(process.env.PALPATE, ["replay", file, "--validate", "--volume", volume], { stdio: "pipe" });
    }
  });
});

test("DICOM that is chosen and OME-Zarr at an address are opened, and what cannot be read is told", { skip, timeout: 1500000 }, async () => {
  rmSync(volumes, { recursive: true, force: true });
  mkdirSync(volumes);
  execFileSync("/usr/bin/python3", ["-B", join(process.env.PALPATE_SOURCE, "tests/bindings/web/make_volumes.py"), volumes], { stdio: "inherit" });
  await opened(async (page) => {
    const surface = async (act) => {
      await page.evaluate(() => (document.body.dataset.surface = "0"));
      await act();
      await page.waitForFunction(() => Number(document.body.dataset.surface) > 0, { timeout: 150000 });
    };
    await page.click("summary");
    const slices = ["0", "1", "2", "3"].map((name) => join(volumes, "implicit", `${name}.dcm`));
    await surface(async () => (await page.$("#file")).uploadFile(...slices));
    assert.deepEqual(await page.$$eval("#marks button", (buttons) => buttons.map(({ textContent }) => textContent)), ["Skin", "Bone"]);
    assert.equal(await page.$eval("#isovalue", ({ max }) => Number(max)), 147);
    await picture(page, "dicom");
    await page.type("#address", "/volumes/blosc_lz4.zarr");
    await surface(() => page.click("#remote button"));
    assert.equal(await page.$eval("#isovalue", ({ max }) => Number(max)), 499);
    assert.match(await page.$eval("#notes", ({ textContent }) => textContent), /of 2 channels, 0 was taken/);
    await (await page.$("#file")).uploadFile(join(volumes, "compressed.dcm"));
    await says(page, /Error: .*convert it first/);
    assert.match(await page.$eval("#said", ({ textContent }) => textContent), /Error: .*convert it first/);
    await page.keyboard.press("Shift"); // an error stays until the next action
    await says(page, /Move, and press/);
  }, ["404 (Not Found)"]); // where a Zarr has no zarr.json
});

test("once loaded, the page works without a network, and sleeps between ticks on any server", { skip, timeout: 1500000 }, async () => {
  const site = await served(false);
  const browser = await launched();
  try {
    const page = await browser.newPage();
    const drawn = () => page.waitForFunction(() => Number(document.body.dataset.surface) > 0, { timeout: 150000 });
    await page.goto(site.address);
    await drawn();
    assert.equal(await page.evaluate(() => crossOriginIsolated), false);
    await page.evaluate(async () => (await navigator.serviceWorker.ready).active.state);
    await page.waitForFunction(() => navigator.serviceWorker.controller);
    site.server.closeAllConnections();
    await new Promise((closes) => site.server.close(closes));
    await page.reload();
    await drawn();
    assert.equal(await page.evaluate(() => crossOriginIsolated), true);
    await page.evaluate(() => import("./zarr.js")); // what was not needed yet
    await page.evaluate(() => import("./fzstd.js"));
  } finally {
    await browser.close();
  }
});

test("another volume ends the recording of the one before", { skip, timeout: 1500000 }, async () => {
  await opened(async (page) => {
    await page.click("#record");
    await page.evaluate(() => (document.body.dataset.surface = "0"));
    await page.select("#volume", "synthetic:torus:64x64x64");
    await page.waitForSelector("#save:not([hidden])", { timeout: 150000 });
    const text = await page.evaluate(async () => (await fetch(document.getElementById("save").href)).text());
    assert.match(text, /visible_human_head[^]*# end \{/);
    assert.equal(await page.$eval("#record", (button) => button.getAttribute("aria-pressed")), "false");
    await page.waitForFunction(() => Number(document.body.dataset.surface) > 0, { timeout: 150000 });
    await says(page, /press to touch/);
  });
});

/** In the browser: presses on a ball from a page that draws nothing, then lets `hinder` happen. Returns the forces [N]
 * before and after, and the loop's report. */
async function hindered(hinder) {
  const { Hand } = await import("/hand.js");
  const heard = { snapshots: [] };
  const hears = (name) => new Promise((resolve) => (heard[name] = resolve));
  const hand = new Hand({
    ready: () => heard.ready(),
    report: (value) => heard.report(value),
    snapshot: (now) => heard.snapshots.push(Math.hypot(...now.force)),
    error: (text) => heard.snapshots.push(text),
  });
  const ready = hears("ready");
  hand.send("begin", { scene: "sphere:48x48x48", setup: { settings: { force: { stale_after: 0.08 } } } });
  await ready;
  let z = 30;
  const reads = setInterval(() => hand.read([0, 0, (z = Math.max(12, z - 0.3))]), 5);
  while (!(heard.snapshots.at(-1) > 1)) await new Promise((resolve) => setTimeout(resolve, 20));
  const before = heard.snapshots.at(-1);
  heard.snapshots = [];
  clearInterval(reads); // as no frame is drawn
  if (hinder === "block") for (const until = performance.now() + 1000; performance.now() < until; );
  if (hinder === "hide") {
    Object.defineProperty(document, "hidden", { value: true });
    document.dispatchEvent(new Event("visibilitychange"));
    await new Promise((resolve) => setTimeout(resolve, 1000));
  }
  const after = await new Promise((resolve) => setTimeout(() => resolve(heard.snapshots), 100));
  const report = hears("report");
  hand.send("report");
  return { before, after, report: await report };
}

for (const isolated of [true, false]) {
  test(`a page that is blocked or hidden gives no force, ${isolated ? "" : "not "}isolated`, { skip, timeout: 1500000 }, async (t) => {
    const site = await served(isolated);
    const browser = await launched();
    try {
      for (const hinder of ["block", "hide"]) {
        const page = await browser.newPage();
        await page.goto(site.address.replace("index.html", "page.css"));
        const { before, after, report } = await page.evaluate(hindered, hinder);
        t.diagnostic(`${hinder}: ${JSON.stringify(report)}`);
        assert.ok(before > 1);
        assert.ok(after.length > 2, String(after));
        assert.equal(after.at(-1), 0, String(after));
      }
    } finally {
      await browser.close();
      site.server.close();
    }
  });
}
