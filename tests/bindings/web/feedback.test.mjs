// Sound and rumble follow the contact.
import assert from "node:assert/strict";
import { join } from "node:path";
import test from "node:test";

const page = join(process.env.PALPATE_WEB, "page");
const { contactOf, shake } = await import(join(page, "feedback.js"));
const { forceText } = await import(join(page, "devices.js"));
const { labelOf } = await import(join(page, "settings.js"));

const none = { strike: 0, push: 0, scrape: 0 };
const at = (time, x, more = {}) => ({ time, hip: [x, 0, 0], scp: [x, 0, 0], force: [0, 0, 1.65], constrained: true, ...more });
const free = { constrained: false, force: [0, 0, 0] };

test("a contact strikes once, then scrapes as fast and as hard as the proxy does", () => {
  assert.deepEqual(contactOf(at(0, 0, free), at(0.016, 1, free)), none);
  const struck = contactOf(at(0, 0, free), at(0.02, 3));
  assert.deepEqual(struck, { strike: 1, push: 0.5, scrape: 0 });
  assert.ok(contactOf(at(0, 0, free), at(0.02, 0)).strike > 0, "a slow touch is heard");
  assert.deepEqual(contactOf(at(0, 0), at(0.02, 1.5)), { strike: 0, push: 0.5, scrape: 0.25 });
  assert.deepEqual(contactOf(at(0, 0), at(0.02, 0)), { strike: 0, push: 0.5, scrape: 0 });
  assert.deepEqual(contactOf(at(0, 0), at(0.02, 3, { force: [0, 0, 0] })), none, "without a force there is nothing to hear");
  assert.deepEqual(contactOf(at(5, 0), at(0, 3)), none, "another session");
});

test("a gamepad is shaken as hard as the surface pushes", () => {
  const played = [];
  const pad = { vibrationActuator: { playEffect: async (...effect) => played.push(effect) } };
  shake([null, {}, pad], { strike: 0, push: 0.5, scrape: 0.25 });
  assert.deepEqual(played, [["dual-rumble", { duration: 60, strongMagnitude: 0.2, weakMagnitude: 0.25 }]]);
});

test("settings have names that one can read", () => {
  assert.deepEqual(["force.stiffness", "friction.static_coefficient", "force.magnet.peak"].map(labelOf), ["Stiffness", "Static friction", "Magnet peak"]);
});

test("a force that waits for the hand to leave is told", () => {
  assert.equal(forceText({ flags: 0, force: [0, 3, 4] }), "5.0 N");
  assert.equal(forceText({ flags: 64 | 4, force: [0, 0, 0] }), "0.0 N until the hand is lifted,");
});
