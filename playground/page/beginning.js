// Typing, the seed, tabs, links, export; and how it all begins.

const PAUSE = 400, SLIDE = 120, LARGEST_LINK = 1000000;
const MARK = "scenic1=";
let timer = null;

let painting = 0;

function edited() {  // colours follow before the next frame is painted: many edits at a time are one
  if (!painting) painting = requestAnimationFrame(() => { painting = 0; colour(); mark(); });
  if (!state.typing) { state.typing = true; problems = []; }
  changed(PAUSE);
}

// Something that decides the scenes has changed: nothing that was drawn before counts any more.
function changed(pause) {
  if (followDialect(program.value)) showReadings();
  state.version++;
  cancelAll();
  clearTimeout(timer);
  nowAt = null;
  for (const id of ["grid", "detail", "tally", "chart", "trace-body", "compared", "stage", "replay-tally"]) at(id).classList.add("stale");
  stopPlaying();
  showStatus();
  timer = setTimeout(draw, pause);
  if (!state.typing) mark();
}

function draw() {
  if (state.typing) showProblems([]);
  state.typing = false;
  state.printed = null; state.baseTally = null; state.baseProblem = null;
  counting = tracing = simulating = "";
  if (surveyedAt !== state.version) { surveyed.clear(); say("reading-message", ""); showReadings(); }
  for (const id of ["chart", "trace-body", "stage"]) at(id).hidden = true;
  for (const id of ["tally", "compared", "replay-tally"]) at(id).replaceChildren();
  for (const id of ["grid", "detail", "tally", "chart", "trace-body", "compared", "stage", "replay-tally"]) at(id).classList.remove("stale");
  for (const id of ["trace-message", "replay-message", "histogram-message"]) say(id, "");
  at("detail").hidden = true;
  askScenes();
  askForTab();
  remember();
}

function askForTab() {
  if (state.tab === "histogram") histogramIfNeeded();
  if (state.tab === "trace") traceIfNeeded();
  if (state.tab === "replay") replayIfNeeded();
}

at("slider").oninput = () => { at("seed").value = at("slider").value; changed(SLIDE); };
at("seed").oninput = () => { at("slider").value = Math.min(Math.max(seed(), 0), 200); changed(PAUSE); };
at("count").onchange = () => changed(0);

// Tabs

const tabs = ["scenes", "rejections", "histogram", "trace", "readings", "replay"];

function openTab(tab) {
  state.tab = tab;
  for (const name of tabs) {
    at(name).hidden = name !== tab;
    at(`tab-${name}`).setAttribute("aria-selected", String(name === tab));
    at(`tab-${name}`).tabIndex = name === tab ? 0 : -1;
  }
  if (tab !== "trace") { nowAt = null; mark(); } else if (trace) goTo(step);
  if (!state.typing) askForTab();
}

tabs.forEach((tab, i) => {
  at(`tab-${tab}`).onclick = () => openTab(tab);
  at(`tab-${tab}`).onkeydown = event => {
    const to = {ArrowRight: i + 1, ArrowLeft: i - 1, Home: 0, End: tabs.length - 1}[event.key];
    if (to === undefined) return;
    const next = tabs[(to + tabs.length) % tabs.length];
    openTab(next);
    at(`tab-${next}`).focus();
  };
});

// Links: what stands behind # is never sent to a server

async function squeezed(stream, data, most = Infinity) {
  const writer = stream.writable.getWriter();
  writer.write(data).catch(() => {});
  writer.close().catch(() => {});
  const parts = [], reader = stream.readable.getReader();
  let size = 0;
  for (;;) {
    const {value, done} = await reader.read();
    if (done) break;
    size += value.length;
    if (size > most) { reader.cancel().catch(() => {}); throw new Error("the link holds too much"); }
    parts.push(value);
  }
  const whole = new Uint8Array(size);
  parts.reduce((place, part) => { whole.set(part, place); return place + part.length; }, 0);
  return whole;
}

async function fragment() {
  const readings = Object.fromEntries(given.readings.filter(r => state.readings[r.id] !== r.paper).map(r => [r.id, state.readings[r.id]]));
  const data = new TextEncoder().encode(JSON.stringify({program: program.value, seed: seed(), readings}));
  const packed = await squeezed(new CompressionStream("deflate-raw"), data);
  let letters = "";
  for (const byte of packed) letters += String.fromCharCode(byte);
  return MARK + btoa(letters).replace(/\+/g, "-").replace(/\//g, "_").replace(/=+$/, "");
}

async function linked(text) {  // what a link holds, null if it is none
  const place = text.indexOf(MARK);
  if (place < 0) return null;
  const letters = atob(text.slice(place + MARK.length).trim().replace(/-/g, "+").replace(/_/g, "/"));
  const data = await squeezed(new DecompressionStream("deflate-raw"), Uint8Array.from(letters, letter => letter.charCodeAt(0)), LARGEST_LINK);
  const found = JSON.parse(new TextDecoder().decode(data));
  if (typeof found.program !== "string" || (found.seed !== undefined && !Number.isSafeInteger(found.seed)) || typeof (found.readings ?? {}) !== "object") throw new Error("it holds no program");
  return {program: found.program, seed: found.seed ?? 0, readings: found.readings ?? {}};
}

// The address holds what is on the page, so that a reload keeps it; not with --trust, where a program from an address must not run by itself.
async function remember() {
  if (given.trust) return;
  const version = state.version, found = await fragment();
  if (state.version === version && found.length < 200000) history.replaceState(null, "", `#${found}`);
}

function takeReadings(readings) {
  for (const r of given.readings) state.readings[r.id] = Object.hasOwn(readings, r.id) && Object.hasOwn(r.alternatives, readings[r.id]) ? readings[r.id] : r.paper;
}

async function openLink(text) {
  let found;
  try { found = await linked(text); } catch (problem) { found = null; }
  if (!found) { say("message", "This link holds no program. Was all of it copied?", true); at("exported").textContent = "This link holds no program."; return false; }
  program.value = found.program;
  at("expression").value = "";
  at("seed").value = found.seed;
  at("slider").value = Math.min(Math.max(found.seed, 0), 200);
  followDialect(found.program);
  takeReadings(found.readings);
  showReadings();
  colour();
  if (given.trust) {
    cancelAll();
    at("ask").showModal();
    at("run-it").onclick = () => { at("ask").close(); changed(0); };
    at("leave-it").onclick = () => { at("ask").close(); say("message", "The program from the link was not run. Change it, and it runs."); };
  } else changed(0);
  return true;
}

addEventListener("hashchange", () => { if (location.hash.includes(MARK)) openLink(location.hash); });
at("open-link").onchange = async event => { if (event.target.value && await openLink(event.target.value)) { event.target.value = ""; unfold(at("export"), false); } };

// Export

function save(data, type, name) {
  const address = URL.createObjectURL(new Blob([data], {type})), anchor = make("a", {href: address, download: name});
  anchor.click();
  setTimeout(() => URL.revokeObjectURL(address), 10000);
  at("exported").textContent = `${name} was saved`;
}

at("save-program").onclick = () => save(program.value, "text/plain;charset=utf-8", given.name);

function savePicture(form) {
  at("exported").textContent = "painting…";
  ask(`picture-${form}`, "picture", {form, count: Math.min(Number(at("count").value), 36)}, found => {
    if (found.kind === "file") save(Uint8Array.from(atob(found.data), letter => letter.charCodeAt(0)), form === "svg" ? "image/svg+xml" : "image/png", found.name);
    else if (messageOf(found)) at("exported").textContent = messageOf(found);
  });
}

at("save-png").onclick = () => savePicture("png");
at("save-svg").onclick = () => savePicture("svg");
at("copy-link").onclick = async () => {
  at("link").value = `${location.origin}/#${await fragment()}`;
  at("link").select();
  try { await navigator.clipboard.writeText(at("link").value); at("exported").textContent = "the link was copied"; } catch { at("exported").textContent = "copy the link below"; }
};
at("export").onclick = () => unfold(at("export"), at("exports").hidden);
document.addEventListener("click", event => { if (!at("export").parentElement.contains(event.target)) unfold(at("export"), false); });
at("export").parentElement.addEventListener("keydown", event => { if (event.key === "Escape") { unfold(at("export"), false); at("export").focus(); } });

// The beginning

at("examples").append(new Option("programs to begin with…", ""), ...given.programs.map((p, i) => new Option(p.title, String(i))));
at("examples").onchange = event => {
  if (event.target.value === "") return;
  program.focus();
  program.select();
  at("expression").value = "";
  if (!document.execCommand("insertText", false, given.programs[Number(event.target.value)].program)) program.value = given.programs[Number(event.target.value)].program;
  program.setSelectionRange(0, 0);
  program.scrollTop = 0;
  event.target.value = "";
  state.selected = null;
  edited();
  changed(0);
};

localStorage.setItem("scenic-ref token", location.pathname.split("/")[1]);
document.title = `${given.name}, scenic-ref play`;
program.value = given.program;
at("seed").value = given.seed;
at("slider").value = Math.min(Math.max(given.seed, 0), 200);
if (given.linked) takeReadings(given.linked);
showReadings();
colour();
if (location.hash.includes(MARK)) openLink(location.hash).then(found => { if (!found) changed(0); }); else changed(0);
