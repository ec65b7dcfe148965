// The programs of the tutorial run, by the code that runs them on the documentation's site.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import test from "node:test";
import { pathToFileURL } from "node:url";

const source = process.env.PALPATE_SOURCE;
const { run } = await import(join(source, "docs/site/cell.js"));
const address = pathToFileURL(join(process.env.PALPATE_WEB, "palpate.js")).href;
const page = readFileSync(join(source, "docs/tutorials/in_javascript.md"), "utf8");
const programs = [...page.matchAll(/^```js\n([^]*?)^```$/gm)].map((match) => match[1]);

const printed = async (program) => {
  const lines = [];
  await run(program, address, (line) => lines.push(line));
  return lines;
};
const vector = (line) => JSON.parse(line.slice(line.indexOf("[")));

test("the proxy stays on the ball while the hand is in it", async () => {
  const [hand, proxy, force] = (await printed(programs[0])).map(vector);
  assert.deepEqual(hand, [0, 0, 20]);
  assert.ok(proxy[2] > hand[2] + 1 && force[2] > 0.1, `${proxy} ${force}`);
});

test("settings change the force", async () => {
  const [force, setting] = await printed(programs[1]);
  const smooth = await printed(programs[1].replaceAll(/^session.set.*friction.*$/gm, ""));
  assert.notDeepEqual(vector(force), vector(smooth[0]));
  assert.equal(setting, "force.stiffness N/mm Stiffness");
});

test("the simulated hand goes deeper into the hole, and back", async () => {
  const [before, hole, after] = (await printed(programs[2])).map(vector);
  assert.ok(Math.hypot(...before.map((x, i) => x - hole[i])) > 0.5, `${before} ${hole}`);
  assert.ok(Math.hypot(...before.map((x, i) => x - after[i])) < 0.1, `${before} ${after}`);
});

test("an error is one of the program", async () => {
  await assert.rejects(printed('import { load } from "palpate";\n(await load()).scene("bagel");'), /cylinder/);
});
