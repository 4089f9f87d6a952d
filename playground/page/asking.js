"use strict";
// What the page knows, and how it asks the server. An answer is shown only if nothing newer was asked for in its slot, and the program is the same.

const given = JSON.parse(document.getElementById("given").textContent);
const at = id => document.getElementById(id);
const page = Array.from(crypto.getRandomValues(new Uint8Array(12)), x => x.toString(16).padStart(2, "0")).join("");
const state = {
  version: 0,  // of the program with its seed and readings
  tab: "scenes", typing: false,
  scenes: [], base: [], selected: null, features: [], names: {}, tally: null, dynamic: false, problem: null,
  readings: {},
};
const defaults = {};  // the readings of the profile
followDialect(given.program);
const asking = {};

function make(tag, properties = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (name === "class") made.className = value;
    else if (name.includes("-") || name === "role") made.setAttribute(name, value);
    else made[name] = value;
  }
  made.append(...children.filter(child => child !== null && child !== undefined));
  return made;
}

// Show what a button controls, or hide it. (A `details` element would do as well, but while one is closed Chromium takes seconds to select long programs.)
function unfold(button, shown) {
  button.setAttribute("aria-expanded", String(shown));
  at(button.getAttribute("aria-controls")).hidden = !shown;
}

function svg(tag, attributes = {}, ...children) {
  const made = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  made.append(...children);
  return made;
}

const number = x => typeof x === "number" ? Number(x.toPrecision(6)).toString() : String(x);
const percent = (x, digits = 1) => `${(100 * x).toFixed(digits)} %`;
const plural = (n, word) => `${n.toLocaleString("en")} ${word}${n === 1 ? "" : "s"}`;
const clipped = (text, most) => { const letters = Array.from(text); return letters.length > most ? letters.slice(0, most - 1).join("") + "…" : text; };

function told(value) {  // a value of the scene format in a few words
  if (typeof value === "number") return number(value);
  if (value !== null && typeof value === "object" && Object.keys(value).length === 1 && "repr" in value) return value.repr;
  if (Array.isArray(value)) return `(${value.map(told).join(", ")})`;
  if (value === null || value === undefined) return "None";
  if (typeof value === "boolean") return value ? "True" : "False";
  return typeof value === "string" ? value : JSON.stringify(value);
}

// The readings that the program's dialect brings, unless the command line chose a profile; those that were switched stay as they are.
function followDialect(text) {
  const named = /^\ufeff?[ \t]*#[ \t]*dialect[ \t]*:[ \t]*(\S+)/.exec(text), dialect = given.dialect ?? (named ? named[1] : "paper");
  const profile = given.profile ?? (Object.hasOwn(given.dialects, dialect) ? given.dialects[dialect] : "paper");
  let moved = false;
  for (const r of given.readings) {
    if (state.readings[r.id] === defaults[r.id]) { moved ||= state.readings[r.id] !== r.under[profile]; state.readings[r.id] = r.under[profile]; }
    defaults[r.id] = r.under[profile];
  }
  return moved;
}

function switchedReadings() { return given.readings.filter(r => state.readings[r.id] !== defaults[r.id]); }

function cancel(slot) {
  if (asking[slot]) { asking[slot].abort(); delete asking[slot]; }
}

function cancelAll() { Object.keys(asking).forEach(cancel); }

const doing = {scenes: "drawing", base: "drawing", histogram: "counting", law: "enumerating", trace: "tracing", survey: "comparing", replay: "simulating", picture: "painting"};

function showStatus() {
  const busy = Object.keys(asking), status = at("status");
  status.classList.toggle("busy", busy.length > 0);
  const count = state.scenes.length;
  status.textContent = busy.length ? `${[...new Set(busy.map(slot => doing[slot.split("-")[0]]))].join(", ")}…` : state.typing ? "typing…" : state.problem ? state.problem : plural(count, "scene");
  document.body.dataset.busy = busy.join(" ");
}

// Ask for a piece of work; `hear` is called with each message, and at the end with one of the kind "done".
async function ask(slot, work, more, hear) {
  cancel(slot);
  const control = new AbortController(), version = state.version;
  asking[slot] = control;
  showStatus();
  const wanted = () => asking[slot] === control && state.version === version;
  const body = {page, slot, work, program: at("program").value, seed: seed(), readings: state.readings, ...more};
  try {
    const answer = await fetch("work", {method: "POST", headers: {"Content-Type": "application/json"}, body: JSON.stringify(body), signal: control.signal});
    if (!answer.ok) throw new Error(answer.status === 403 ? "this page belongs to a server that has ended; open the address of the new one" : await answer.text());
    const reader = answer.body.pipeThrough(new TextDecoderStream()).getReader();
    let rest = "";
    for (;;) {
      const {value, done} = await reader.read();
      if (!wanted()) return;
      const lines = (rest + (value || "")).split("\n");
      rest = lines.pop();
      for (const line of lines) hear(JSON.parse(line));
      if (done) break;
    }
  } catch (problem) {
    if (!wanted()) return;
    hear({kind: "over", message: problem instanceof TypeError ? "The server does not answer. Was it ended?" : problem.message});
  } finally {
    if (asking[slot] === control) { delete asking[slot]; if (state.version === version) hear({kind: "done"}); }
    showStatus();
  }
}

function messageOf(found) {  // what is said of an answer that is no result; "" for others
  if (found.kind === "error") return found.diagnostic.message + (found.diagnostic.hint ? `; ${found.diagnostic.hint}` : "");
  return found.kind === "over" || found.kind === "fault" ? found.message : "";
}

function say(id, text, bad = false) {
  at(id).textContent = text;
  at(id).classList.toggle("bad", bad);
}

function seed() { const found = Number(at("seed").value); return Number.isSafeInteger(found) ? found : 0; }
