// The rules that fired in a run, to step through; the place of each is marked in the program.

let trace = null, visible = [], step = 0, sums = [], tracing = "";
const ROWS = 300;

function traceIfNeeded() {
  const key = JSON.stringify([state.version, at("trace-scene").value, at("trace-attempt").value, at("trace-steps").value, Number(at("trace-steps").value) ? simulation() : ""]);
  if (key === tracing) return;
  tracing = key;
  trace = null;
  at("trace-body").hidden = true;
  say("trace-message", "");
  const index = Math.max(0, Math.floor(Number(at("trace-scene").value))), attempt = at("trace-attempt").value ? Number(at("trace-attempt").value) : null;
  const known = state.scenes.find(s => s.scene === index);
  if (known) fillAttempts(known.attempts);
  ask("trace", "trace", {start: index, attempt, ...simulation(), steps: Math.max(0, Math.floor(Number(at("trace-steps").value)))}, found => {
    if (found.kind === "trace") showTrace(found);
    else if (messageOf(found)) say("trace-message", messageOf(found), true);
  });
}

function fillAttempts(attempts) {
  const before = at("trace-attempt").value, most = Math.min(attempts, 200);
  at("trace-attempt").replaceChildren(new Option(`the accepted one, ${attempts}`, ""), ...Array.from({length: Math.min(most, attempts - 1)}, (_, i) => new Option(`${i + 1}, rejected`, String(i + 1))));
  at("trace-attempt").value = [...at("trace-attempt").options].some(o => o.value === before) ? before : "";
}

function showTrace(found) {
  trace = found;
  let sum = 0;
  sums = trace.events.map(e => sum += typeof e.logDensity === "number" ? e.logDensity : 0);
  say("trace-message", `${trace.title.replace(/^.*?, seed/, "Seed")}: ${trace.ending}` + (trace.count > trace.events.length ? ` (the first ${trace.events.length.toLocaleString("en")} of ${trace.count.toLocaleString("en")} rules are shown)` : ""), trace.error !== null);
  at("trace-body").hidden = false;
  step = 0;
  visible = [];
  filterRules();
}

function isVisible(e) {
  if (["draw", "stuck", "time", "done"].includes(e.kind)) return true;
  const rule = trace.rules[e.rule];
  if (rule && rule.inherited && !at("inherited").checked) return false;
  return !((e.inDefault || e.rule === "P-Default") && !at("defaults").checked);
}

function filterRules() {
  if (!trace) return;
  const number = visible.length ? visible[step].number : 0;
  visible = trace.events.filter(isVisible);
  at("trace-slider").max = Math.max(0, visible.length - 1);
  const next = visible.findIndex(e => e.number >= number);
  goTo(next < 0 ? visible.length - 1 : next);
}

function goTo(i) {
  if (!trace || !visible.length) return;
  step = Math.min(Math.max(i, 0), visible.length - 1);
  const e = visible[step];
  at("trace-slider").value = step;
  at("where").textContent = `${e.number} of ${trace.count.toLocaleString("en")}`;
  nowAt = e;
  mark();
  if (e.line && e.file === given.file) reveal(e.line);
  showRule(e);
  showState(e);
  showRules();
}

function showRule(e) {
  const rule = trace.rules[e.rule] || {name: "", place: "", statement: ""};
  const parts = [make("div", {}, make("span", {class: "id"}, e.rule || "time"), "  ", make("b", {}, rule.name)), make("div", {class: "dim"}, rule.place + (rule.code ? `; code: ${rule.code}` : ""))];
  if (rule.statement) parts.push(make("pre", {}, rule.statement));
  if (e.change) parts.push(make("div", {class: "change"}, e.change));
  const weight = e.kind === "draw" ? `${e.isDensity ? "density" : "probability"} ${typeof e.logDensity === "number" ? number(Math.exp(e.logDensity)) : "0"}; ` : e.kind === "stuck" ? "probability 0; " : "";
  parts.push(make("div", {class: "dim"}, `${weight}log density of the run so far ${number(sums[e.number - 1] ?? 0)}`));
  const text = trace.sources[e.file];
  if (text !== undefined && e.line) parts.push(make("div", {class: "code dim"}, `${e.file}:${e.line}: ${clipped((text.split(/\r\n|\r|\n/)[e.line - 1] || "").trim(), 120)}`));
  at("rule").replaceChildren(...parts);
}

function showState(e) {
  const known = new Map();
  for (const event of trace.events.slice(0, e.number)) for (const [where, name, value] of event.assigned) {
    const key = `${where}(${name})`;
    known.delete(key);
    known.set(key, [value, event.number === e.number]);
  }
  const rows = [...known].reverse().slice(0, 200).map(([key, [value, isNew]]) => make("tr", {class: isNew ? "new" : ""}, make("td", {class: "code"}, key), make("td", {class: "code"}, value)));
  at("state").replaceChildren(make("table", {}, ...rows));
}

function showRules() {
  const first = Math.max(0, Math.min(step - ROWS / 2, visible.length - ROWS));
  at("events").replaceChildren(...visible.slice(first, first + ROWS).map((e, k) => make(
    "button", {class: e.kind, "aria-current": String(first + k === step), tabIndex: first + k === step ? 0 : -1, onclick: () => goTo(first + k)},
    make("span", {class: "n"}, String(e.number)), make("span", {class: "r"}, e.rule), make("span", {class: "c"}, clipped(e.change || (trace.rules[e.rule] || {}).name || "", 120)),
  )));
  const now = at("events").children[step - first];
  if (now) at("events").scrollTop = now.offsetTop - at("events").offsetTop - at("events").clientHeight / 2;
}

at("first").onclick = () => goTo(0);
at("back").onclick = () => goTo(step - 1);
at("forth").onclick = () => goTo(step + 1);
at("last").onclick = () => goTo(visible.length - 1);
at("trace-slider").oninput = event => goTo(Number(event.target.value));
at("inherited").onchange = at("defaults").onchange = filterRules;
at("trace-scene").onchange = () => { at("trace-attempt").value = ""; traceIfNeeded(); };
at("trace-attempt").onchange = at("trace-steps").onchange = traceIfNeeded;
at("trace").addEventListener("keydown", event => {
  const to = {ArrowLeft: step - 1, ArrowUp: step - 1, ArrowRight: step + 1, ArrowDown: step + 1, PageUp: step - 20, PageDown: step + 20, Home: 0, End: visible.length - 1}[event.key];
  if (to === undefined || event.ctrlKey || event.altKey || event.metaKey || ["INPUT", "SELECT"].includes(event.target.tagName)) return;
  event.preventDefault();
  goTo(to);
});
