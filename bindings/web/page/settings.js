// Controls for the numbers of a session, from the module's table. Those of the device's limits are left out: a page can
// only lower them, for good.

const usual = ["force.stiffness", "friction.static_coefficient", "friction.dynamic_coefficient"];

/** "friction.static_coefficient" is "Static friction", "force.magnet.peak" is "Magnet peak". */
export function labelOf(name) {
  const [group, ...rest] = name.split(".");
  const words = rest.join(" ").replaceAll("_", " ").replace("coefficient", group);
  return words[0].toUpperCase() + words.slice(1);
}
/** In a field: empty without a limit, and without digits that only rounding has made. */
const textOf = (value) => (Number.isFinite(value) ? String(Number(value.toPrecision(6))) : "");
const hasLimit = (most) => most < Number.MAX_VALUE;

/** The element of one setting; `change(name, value)` is called with what was entered. */
function controlOf({ name, unit, about, least, most }, change) {
  const label = document.createElement("label");
  const input = Object.assign(document.createElement("input"), { id: `set.${name}`, type: "number", step: "any", placeholder: "none" });
  const note = Object.assign(document.createElement("small"), { id: `about.${name}`, textContent: about });
  if (Number.isFinite(least)) input.min = least;
  if (hasLimit(most)) input.max = most;
  input.setAttribute("aria-describedby", note.id);
  input.onchange = () => change(name, input.value === "" && !input.validity.badInput ? Infinity : input.valueAsNumber);
  note.hidden = about === labelOf(name);
  label.append(labelOf(name) + (unit ? ` [${unit}]` : ""), input);
  const element = document.createElement("div");
  element.append(label, note);
  return element;
}

/** Shows the settings as they are: the usual ones in `first`, the others in `rest`. */
export function showSettings(first, rest, all, change) {
  for (const setting of all.filter(({ name }) => !name.startsWith("limits."))) {
    const isNew = !document.getElementById(`set.${setting.name}`);
    if (isNew) (usual.includes(setting.name) ? first : rest).append(controlOf(setting, change));
    document.getElementById(`set.${setting.name}`).value = textOf(setting.value);
  }
}
