// Measures the page in Chromium: how soon the head can be touched, and with an Inverse3, against the stand-in for Haply's
// service, how late ticks begin, and how soon the force is zero when the page or the connection fails. For an idle machine.
//
//     PALPATE_WEB=build/web/bindings/web/package node benchmarks/web.mjs [SECONDS] [TIMES]
import { announces, hover, opened, says } from "../tests/bindings/web/browser.mjs";
import { Service, connect, felt } from "../tests/bindings/web/service.mjs";

const seconds = Number(process.argv[2] ?? 60);
const times = Number(process.argv[3] ?? 10);
const sleep = (ms) => new Promise((resolve) => setTimeout(resolve, ms));
const within = 700; // [ms] what happens later belongs to the next event
const patience = 30000; // [ms] for a steady force

const service = new Service();
const reportOf = (page) => page.$eval("#report", (list) => [...list.children].map(({ textContent }) => textContent).join("  "));

/** The hand has felt a force for a while. */
async function pressed(page) {
  for (const until = Date.now() + patience; Date.now() < until; ) {
    const from = Date.now();
    await sleep(300);
    const sizes = service.forces.filter(({ at }) => at >= from).map(({ size }) => size);
    if (sizes.length > 0 && Math.min(...sizes) > felt) return;
  }
  throw new Error(`no steady force within ${patience / 1000} s; the page says: ${await page.$eval("#state", ({ textContent }) => textContent)}  ${await reportOf(page)}`);
}

/** The forces of the session as the page hears them. */
const listen = () => {
  window.heard = [];
  window.Worker = class extends window.Worker {
    constructor(...all) {
      super(...all);
      this.addEventListener("message", ({ data }) => data.snapshot && window.heard.push([Date.now(), Math.hypot(...data.snapshot.force)]));
    }
  };
};

/** Each lets something happen, and returns the time until the last force, or until none is rendered [ms]. */
const events = {
  async "blocked page"(page) {
    const from = await page.evaluate((ms) => {
      const begun = Date.now();
      while (Date.now() < begun + ms);
      return begun;
    }, within);
    return service.lastForceSince(from, within);
  },
  async "hidden page"(page) {
    const from = Date.now();
    const other = await page.browser().newPage();
    await sleep(within);
    const last = service.lastForceSince(from, within);
    await other.close();
    await page.bringToFront();
    return last;
  },
  async "silent service"() {
    const from = Date.now();
    service.answers = false;
    await sleep(within);
    service.answers = true;
    return service.lastForceSince(from, within);
  },
  async "lost connection"(page) {
    const from = Date.now();
    service.drop();
    await sleep(within);
    const heard = await page.evaluate(() => window.heard);
    return heard.find(([at, size]) => at >= from && size === 0)[0] - from;
  },
};

/** Until the zero that follows the last force, or else until the service sees the connection end. */
async function closed(page) {
  const from = Date.now();
  await page.close();
  while (service.server.clients.size > 0) await sleep(1);
  const zero = service.forces[service.forces.findLastIndex(({ size }) => size > 0) + 1];
  return Math.max(0, (zero?.at ?? service.closedAt) - from);
}

async function start() {
  await opened(async (page, site) => {
    const sinceBegin = () => page.evaluate(() => Math.round(performance.now()));
    const [seen, bytes] = [await sinceBegin(), site.bytes()];
    await hover(page);
    await page.mouse.down();
    await says(page, /In contact/);
    console.log(`the head is seen after ${seen} ms and touched after ${await sinceBegin()} ms; ${(bytes / 1e6).toFixed(2)} MB without it`);
  });
}

const show = (name, list) => {
  list.sort((a, b) => a - b);
  console.log(`${name.padEnd(16)} median ${list[Math.floor(list.length / 2)]} ms, at most ${list.at(-1)} ms (${list.length} times)`);
};

try {
  await start();
  const address = await service.listens();
  const closings = [];
  for (let i = 0; i < times; ++i) {
    await opened(async (page) => {
      await connect(page, address);
      await pressed(page);
      if (i === 0) {
        await announces(page, /In contact/);
        await sleep(1000 * seconds);
        console.log(await reportOf(page));
        for (const [name, happen] of Object.entries(events)) {
          const all = [];
          for (let n = 0; n < times; ++n) {
            await pressed(page);
            all.push(await happen(page));
          }
          show(name, all);
        }
        await pressed(page);
      }
      closings.push(await closed(page));
    }, { prepare: (page) => page.evaluateOnNewDocument(listen), expected: ["WebSocket connection"] });
  }
  show("closed page", closings);
} finally {
  service.close();
}
