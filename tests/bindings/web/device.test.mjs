// Devices of the page in Chromium: they move the hand, and the force ends when the page is blocked. Times are slower here. The limits
// are tested to the millisecond in session.test.mjs.
import assert from "node:assert/strict";
import test from "node:test";

import { announces, installed, opened, picture, says, skip } from "./browser.mjs";
import { Service, connect, felt, inFront } from "./service.mjs";

const without = skip || (!installed("ws") && "ws is not installed (scripts/deep/web)");
const expected = ["ERR_CONNECTION_REFUSED", "WebSocket connection"];
const slowness = 60;

const gone = (service) => service.until(({ size }) => size === 0);
const presses = (service) => service.until(({ size }) => size > felt);

test("an Inverse3 presses until the page is blocked, hidden or closed, or the connection lost, and presses again", { skip: without, timeout: 1500000 }, async () => {
  const service = new Service();
  try {
    await opened(async (page) => {
      [service.y, service.way] = [-0.058, 0]; // rests deep in the head
      await connect(page, await service.listens());
      await announces(page, /In contact/);
      await says(page, /until the hand is lifted/);
      [service.y, service.way] = [inFront, 0.0003];
      await page.click("#lift");
      await presses(service);
      await page.waitForFunction(() => document.getElementById("report").textContent.includes("Inverse3 049D"));
      await picture(page, "inverse3");

      const blocked = page.evaluate((ms) => {
        const until = Date.now() + ms;
        while (Date.now() < until);
      }, 150 * slowness);
      await gone(service);
      await blocked;
      await presses(service);

      const { connections } = service;
      service.drop();
      service.forces = [];
      await service.until(() => service.connections > connections);
      await presses(service);

      const other = await page.browser().newPage(); // in front: the page is hidden
      await gone(service);
      await other.close();
      await page.bringToFront();
      await presses(service);

      await page.close();
      await service.until(() => service.closedAt > 0 && service.server.clients.size === 0);
    }, { expected, slowness });
  } finally {
    service.close();
  }
});

test("a service that is not there is told, and the mouse stays", { skip: without, timeout: 1500000 }, async () => {
  const service = new Service();
  const address = await service.listens();
  service.close();
  await opened(async (page) => {
    await connect(page, address);
    await says(page, /Error: nothing to talk to/);
    await page.keyboard.press("Shift"); // an error stays until the next action
    await says(page, /press to touch/);
    assert.equal(await page.$eval("#connect", (button) => button.textContent), "Connect the Inverse3");
  }, { expected });
});

test("a SpaceMouse moves the hand, and is unplugged", { skip, timeout: 1500000 }, async () => {
  await opened(async (page) => {
    // The browser's dialog and the mouse are missing here.
    await page.evaluate(() => {
      window.puck = { opened: false, open: async () => (window.puck.opened = true) };
      window.hid = { requestDevice: async () => [window.puck] };
      Object.defineProperty(navigator, "hid", { value: window.hid, configurable: true });
      document.getElementById("puck").click();
    });
    await says(page, /Move the device to touch/);
    await page.evaluate(() => window.puck.oninputreport({ reportId: 1, data: new DataView(Uint8Array.of(0, 0, 0xa2, 0xfe, 0, 0).buffer) }));
    await says(page, /In contact/);
    await page.evaluate(() => window.hid.ondisconnect({ device: window.puck }));
    await says(page, /press to touch/);
  });
});

test("a simulated hand touches, and gives way to the mouse", { skip, timeout: 1500000 }, async () => {
  await opened(async (page) => {
    await page.click("main details:nth-of-type(2) summary");
    await page.select("#motion", "hold");
    await page.evaluate(() => (document.body.dataset.surface = "0"));
    await page.focus("#simulate");
    await page.keyboard.press("Enter");
    await says(page, /In contact/);
    await page.waitForFunction(() => document.getElementById("report").textContent.includes("simulated"));
    await page.waitForFunction(() => Number(document.body.dataset.surface) > 0);
    await page.evaluate(() => scrollTo(0, 0));
    await picture(page, "simulated");
    await page.focus("#simulate");
    await page.keyboard.press("Enter");
    await says(page, /press to touch/);
  });
});
