// The page in Chromium: a mouse touches, presses through, drills, undoes and records. Pictures are kept for people.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdirSync, rmSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import test from "node:test";

import { hover, launched, newPage, opened, picture, pictures, says, served, skip, volumes } from "./browser.mjs";

test("the head is touched, pressed through, drilled and recorded", { skip, timeout: 1500000 }, async () => {
  await opened(async (page, site) => {
    assert.ok(site.bytes() < 1e6, `${site.bytes()} bytes`);
    await picture(page, "loaded");
    await page.click("#record");
    await hover(page);
    await says(page, /press to touch/);
    await page.mouse.down();
    await says(page, /In contact: .* at level 35/);
    await picture(page, "touch");
    await page.mouse.up();
    await says(page, /press to touch/);

    await page.click("#through");
    await hover(page);
    await page.mouse.down();
    await says(page, /at level ([4-9]\d|1\d\d)/);
    await picture(page, "through");
    await page.mouse.up();
    await page.click("#through");

    await page.click("#drill");
    const surfaces = () => page.evaluate(() => Number(document.body.dataset.surface));
    const more = () => page.waitForFunction((n) => Number(document.body.dataset.surface) > n, {}, before);
    await hover(page);
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

test("the hand presses while no frame is drawn", { skip, timeout: 1500000 }, async () => {
  await opened(async (page) => {
    await hover(page);
    await page.mouse.down();
    await says(page, /In contact/);
  }, { prepare: (page) => page.evaluateOnNewDocument(() => {
    const real = window.requestAnimationFrame;
    window.requestAnimationFrame = (call) => (call.name === "frame" ? 0 : real(call));
  }) });
});

test("the surface is drawn once, and hides what is behind it", { skip, timeout: 1500000 }, async () => {
  await opened(async (page) => {
    const seen = await page.evaluate(async () => {
      const { Scene } = await import("./scene.js");
      const canvas = Object.assign(document.createElement("canvas"), { style: "width: 450px; height: 450px" });
      document.body.append(canvas);
      const scene = new Scene(canvas);
      const { gl } = scene;
      let calls = 0;
      let triangles = 0;
      gl.drawElements = function (kind, count, ...rest) {
        ++calls;
        triangles += count === 3;
        return WebGL2RenderingContext.prototype.drawElements.call(gl, kind, count, ...rest);
      };
      const show = (level) => scene.show([{ vertices: Float32Array.of(-90, -90, level, 90, -90, level, 0, 90, level), normals: new Float32Array(0), triangles: Uint32Array.of(0, 1, 2) }],
        { rotation: [[1, 0, 0], [0, 1, 0], [0, 0, 1]], translation: [0, 0, 0], scale: 1 });
      const besideMiddle = (z) => {
        scene.draw({ scp: [0, 0, z], force: [0, 0, 0], constrained: true }, [20, 20, z]);
        const pixel = new Uint8Array(4);
        gl.readPixels(canvas.width / 2 - 3, canvas.height / 2, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
        return pixel[1] > pixel[0] / 2 ? "surface" : "proxy";
      };
      show(0);
      const first = [besideMiddle(-20), besideMiddle(20), besideMiddle(-20), triangles, gl.getError()];
      calls = 0;
      scene.draw({ scp: [0, 0, -20], force: [0, 0, 0], constrained: true }, [20, 20, -20]);
      const again = calls;
      show(-40);
      return [...first, again, besideMiddle(-20), triangles];
    });
    assert.deepEqual(seen, ["surface", "proxy", "surface", 1, 0, 0, "proxy", 2]);
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
      await page.waitForFunction(() => Number(document.body.dataset.surface) > 0);
    };
    await page.click("summary");
    const slices = ["0", "1", "2", "3"].map((name) => join(volumes, "implicit", `${name}.dcm`));
    await surface(async () => (await page.$("#file")).uploadFile(...slices));
    assert.deepEqual(await page.$$eval("#marks button", (buttons) => buttons.map(({ textContent }) => textContent)), ["Skin", "Bone"]);
    assert.equal(await page.$eval("#isovalue", ({ max }) => Number(max)), 147);
    const name = () => page.$eval("#volume", ({ selectedOptions: [one] }) => one.textContent);
    assert.equal(await name(), "0.dcm");
    await picture(page, "dicom");
    await surface(async () => (await page.$("#file")).uploadFile(join(volumes, "pair", "head.hdr"), join(volumes, "pair", "head.img")));
    assert.equal(await page.$eval("#isovalue", ({ max }) => Number(max)), 7);
    assert.match(await page.$eval("#notes", ({ textContent }) => textContent), /says nothing of its orientation/);
    await page.type("#address", "/volumes/blosc_lz4.zarr");
    await surface(() => page.click("#remote button"));
    assert.equal(await page.$eval("#isovalue", ({ max }) => Number(max)), 499);
    assert.match(await page.$eval("#notes", ({ textContent }) => textContent), /of 2 channels, 0 was taken/);
    assert.equal(await page.$eval("#said", ({ textContent }) => textContent), "blosc_lz4.zarr is open");
    await (await page.$("#file")).uploadFile(join(volumes, "compressed.dcm"));
    await says(page, /Error: .*convert it first/);
    assert.match(await page.$eval("#said", ({ textContent }) => textContent), /Error: .*convert it first/);
    assert.equal(await name(), "blosc_lz4.zarr");
    await page.keyboard.press("Shift"); // an error stays until the next action
    await says(page, /Move, and press/);
  }, { expected: ["404 (Not Found)"] }); // where a Zarr has no zarr.json
});

test("once loaded, the page works without a network, and sleeps between ticks on any server", { skip, timeout: 1500000 }, async () => {
  const site = await served(false);
  const browser = await launched();
  try {
    const page = await newPage(browser);
    const drawn = () => page.waitForFunction(() => Number(document.body.dataset.surface) > 0);
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
    await page.waitForSelector("#save:not([hidden])");
    const text = await page.evaluate(async () => (await fetch(document.getElementById("save").href)).text());
    assert.match(text, /visible_human_head[^]*# end \{/);
    assert.equal(await page.$eval("#record", (button) => button.getAttribute("aria-pressed")), "false");
    await page.waitForFunction(() => Number(document.body.dataset.surface) > 0);
    await says(page, /press to touch/);
  });
});

test("a volume that arrives late does not replace the one that was asked for after it", { skip, timeout: 1500000 }, async () => {
  await opened(async (page, site) => {
    const late = page.waitForResponse((response) => response.url().includes("held"));
    await page.evaluate(() => {
      document.getElementById("address").value = "/page/visible_human_head.nrrd?held";
      document.getElementById("remote").requestSubmit();
      document.body.dataset.surface = "0";
    });
    await page.select("#volume", "synthetic:torus:64x64x64");
    await page.waitForFunction(() => Number(document.body.dataset.surface) > 0);
    const most = () => page.$eval("#isovalue", ({ max }) => Number(max));
    const torus = await most();
    site.release();
    await (await late).buffer();
    await page.evaluate(async () => {
      for (let i = 0; i < 60; ++i) await new Promise(requestAnimationFrame);
    });
    assert.equal(await most(), torus);
    assert.equal(await page.evaluate(() => document.body.dataset.surface), "1", "no other surface was made");
  });
});

test("settings are changed by keyboard, and one that is refused is told", { skip, timeout: 1500000 }, async () => {
  await opened(async (page) => {
    const id = '[id="set.force.stiffness"]';
    const enter = async (text) => {
      await page.click(id, { count: 3 });
      await page.keyboard.type(text);
      await page.keyboard.press("Enter");
    };
    const value = () => page.$eval(id, (input) => input.value);
    assert.equal(await page.$eval(id, (input) => document.getElementById(input.getAttribute("aria-describedby")).textContent), "Stiffness");
    const press = async () => {
      await hover(page);
      await page.mouse.down();
    };
    await press();
    await says(page, /In contact: 2\.[5-9]/); // 5 mm of view depth at 0.5 N/mm, and more where the surface slopes
    await page.mouse.up();
    await enter("0.1");
    await press();
    await says(page, /In contact: 0\.[45]/);
    await page.mouse.up();
    await enter("-1");
    await says(page, /Error: stiffness .* must be/);
    assert.equal(await value(), "0.1");
  }, { slowness: 20 });
});

test("a hand that rests leaves a shell that it was pressed into", { skip, timeout: 1500000 }, async () => {
  await opened(async (page) => {
    await page.evaluate(() => (document.body.dataset.surface = "0"));
    await page.select("#volume", "synthetic:shepp-logan:64x64x64");
    await page.waitForFunction(() => Number(document.body.dataset.surface) > 0);
    const enter = (id, text) => page.$eval(id, (input, value) => {
      input.value = value;
      input.dispatchEvent(new Event("input"));
    }, text);
    await enter("#isovalue", "600"); // the skull, which is hollow
    await enter("#press", "12");
    await page.click("#through");
    await hover(page);
    await page.mouse.down();
    await says(page, /In contact/);
    await says(page, /Approaching/); // inside
    await page.$eval("#through", (box) => box.click());
    await page.mouse.up();
    assert.equal(await page.evaluate(async () => {
      const rests = ({ hip }) => hip[1] < -34.2; // [mm, physical]
      for (let count = 0, last = null; count < 20; await new Promise((resolve) => setTimeout(resolve, 5))) {
        if (window.heard !== last) count = rests((last = window.heard)) ? count + 1 : 0;
      }
      return window.heard.constrained;
    }), false);
  }, { slowness: 20, prepare: (page) => page.evaluateOnNewDocument(() => {
    window.Worker = class extends window.Worker {
      constructor(...all) {
        super(...all);
        this.addEventListener("message", ({ data }) => (window.heard = data.snapshot ?? window.heard));
      }
    };
  }) });
});

test("a contact is heard, and silence is silent", { skip, timeout: 1500000 }, async () => {
  await opened(async (page) => {
    const loudness = (contact) => page.evaluate(async (heard) => {
      const { Sound } = await import("./feedback.js");
      const context = new OfflineAudioContext(1, 24000, 24000);
      const sound = new Sound(context);
      if (heard) sound.hear(heard, 0.1);
      const samples = (await context.startRendering()).getChannelData(0);
      const rms = (from, to) => Math.hypot(...samples.subarray(from * 24000, to * 24000)) / Math.sqrt((to - from) * 24000);
      return [rms(0, 0.09), rms(0.1, 0.2), rms(0.5, 1)];
    }, contact);
    assert.deepEqual(await loudness(null), [0, 0, 0]);
    const [before, during, after] = await loudness({ strike: 0, push: 1, scrape: 1 });
    assert.equal(before, 0);
    assert.ok(during > 0.02, String(during));
    assert.ok(after < 1e-4 * during, "it ends by itself");
    assert.ok((await loudness({ strike: 1, push: 1, scrape: 0 }))[1] > 0.01);
    for (const pressed of ["true", "false"]) {
      await page.focus("#sound");
      await page.keyboard.press("Enter");
      assert.equal(await page.$eval("#sound", (button) => button.getAttribute("aria-pressed")), pressed);
    }
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
        const page = await newPage(browser);
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
