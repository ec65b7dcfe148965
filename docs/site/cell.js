// Programs on a page that a reader can change and run. What they print appears below them.

const rounded = (key, value) => (typeof value === "number" ? Number(value.toFixed(3)) : value);
const text = (value) => (typeof value === "string" ? value : JSON.stringify(value, rounded));

/** Runs a program that imports "palpate" from this address. `print` gets each line. */
export async function run(program, address, print) {
  const body = program.replace(/^import (.*) from "palpate";$/gm, `const $1 = await import(${JSON.stringify(address)});`);
  const AsyncFunction = (async () => {}).constructor;
  await new AsyncFunction("console", body)({ log: (...values) => print(values.map(text).join(" ")) });
}

function enliven(cell) {
  const program = cell.querySelector("textarea");
  const button = Object.assign(document.createElement("button"), { type: "button", textContent: "Run" });
  const output = document.createElement("output");
  const print = (line) => (output.textContent += `${line}\n`);
  cell.append(button, output);
  button.onclick = async () => {
    output.textContent = "";
    await run(program.value, new URL(cell.dataset.module, document.baseURI).href, print).catch(print);
  };
  program.onkeydown = (event) => {
    if (event.key === "Enter" && (event.ctrlKey || event.metaKey)) button.click();
  };
}

if (globalThis.document && location.protocol !== "file:") document.querySelectorAll(".cell").forEach(enliven); // modules need a server
