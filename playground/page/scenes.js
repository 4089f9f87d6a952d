// The grid of scenes, one scene in full, and what rejected.

function askScenes() {
  state.scenes = []; state.base = []; state.features = []; state.names = {}; state.tally = null; state.problem = null; state.dynamic = false;
  classes.clear();
  at("grid").replaceChildren();
  document.body.classList.remove("partly");
  at("grid").classList.remove("stale");
  say("message", "");
  rejected = new Map();
  let warnings = [], notes = [], error = null;
  const count = Number(at("count").value);
  at("grid").style.setProperty("--card", count <= 4 ? "300px" : count <= 16 ? "165px" : "120px");
  ask("scenes", "scenes", {count}, found => {
    if (found.kind === "checked") { warnings = found.diagnostics; notes = found.notes; state.dynamic = found.dynamic; showProblems(warnings, notes); }
    else if (found.kind === "scene") addScene(found);
    else if (found.kind === "tally") { state.tally = found; showTally(); }
    else if (found.kind === "printed") { state.printed = found; showTally(); notes = [...notes.filter(n => !n.startsWith("printed")), `printed in ${found.scene === null ? "the attempt that failed" : `scene ${found.scene}`}: ${found.lines.join(" | ")}`]; }
    else if (found.kind === "features") { state.features = found.features; state.names = found.names; showFeatures(); }
    else if (messageOf(found)) {
      error = found;
      state.problem = found.kind === "over" ? "stopped" : found.kind === "fault" ? "a fault" : found.exhausted ? "no scene" : "an error";
      say("message", messageOf(found), true);
    } else if (found.kind === "done") {
      showProblems([...(error && error.diagnostic ? [error.diagnostic] : []), ...warnings], notes);
      showTally();
      if (state.selected !== null && state.selected >= state.scenes.length) state.selected = null;
      showDetail();
      compare();
      if (!state.scenes.length) at("detail").hidden = true;
    }
  });
  if (switchedReadings().length) askBase(count); else cancel("base");
}

function askBase(count) {
  ask("base", "scenes", {count, readings: defaults}, found => {
    if (found.kind === "scene") { state.base.push(found); compare(); }
    else if (found.kind === "tally") { state.baseTally = found; compare(); }
    else if (messageOf(found)) { state.baseProblem = messageOf(found); compare(); }
  });
}

function addScene(scene) {
  state.scenes.push(scene);
  if (!scene.problem && scene.view.length && !scene.allSeen) document.body.classList.add("partly");  // what ego sees is told apart in some scene
  if (scene.objects.some(o => o.properties.behavior)) state.dynamic = true;
  const card = make(
    "button", {class: "card", "aria-pressed": "false", title: "show it in full", onclick: () => choose(scene.scene)}, drawScene(scene),
    make("span", {class: "caption"}, make("b", {}, `scene ${scene.scene}`), make("span", {}, plural(scene.attempts, "attempt"))),
  );
  at("grid").append(card);
  if (state.selected === scene.scene) showDetail();
}

// Angles are radians in programs and files, and degrees where they are told in a sentence: here both.
const ANGLES = new Set(["heading", "viewAngle", "headingStdDev", "roadDeviation"]);
const inRadians = value => `${number(value)} rad (${number(value * 180 / Math.PI)}°)`;

function choose(index) {
  state.selected = state.selected === index ? null : index;
  showDetail();
  if (state.selected !== null) at("detail").scrollIntoView({block: "nearest"});
}

function showDetail() {
  const scene = state.scenes.find(s => s.scene === state.selected);
  [...at("grid").children].forEach((card, i) => card.setAttribute("aria-pressed", String(state.scenes[i] === scene && scene !== undefined)));
  at("detail").hidden = scene === undefined;
  if (scene === undefined) return;
  const rows = [];
  for (const [name, value] of Object.entries(scene.params)) rows.push(["param", name, told(value)]);
  for (const o of scene.objects.slice(0, 60)) {
    const own = {position: o.position, heading: o.heading, width: o.width, length: o.length, ...o.properties};
    for (const [name, value] of Object.entries(own)) rows.push([`${nameOf(o, scene.ego)} (${o.id})`, name, ANGLES.has(name) && typeof value === "number" ? inRadians(value) : told(value)]);
  }
  const body = make("tbody");
  rows.forEach(([who, name, value], i) => body.append(make("tr", {}, make("td", {}, i && rows[i - 1][0] === who ? "" : who), make("td", {class: "code property"}, name), make("td", {class: "code"}, value))));
  const trace = (attempt) => { at("trace-scene").value = scene.scene; fillAttempts(scene.attempts); at("trace-attempt").value = attempt; at("trace-steps").value = 0; openTab("trace"); };
  at("detail").replaceChildren(
    make("div", {}, make("h2", {}, `Scene ${scene.scene} of seed ${scene.seed}`), drawScene(scene, 360), make(
      "div", {class: "controls"}, make("button", {onclick: () => trace("")}, "Trace it"),
      scene.attempts > 1 ? make("button", {onclick: () => trace("1")}, "Why was attempt 1 rejected?") : null,
      make("button", {onclick: () => choose(scene.scene)}, "Close"),
    )),
    make("div", {class: "scroll"}, make("table", {}, make("thead", {}, make("tr", {}, ...["object", "property", "value"].map(h => make("th", {}, h)))), body)),
  );
}

// What rejected how often

function showTally() {
  const tally = state.tally;
  if (!tally) { at("tally").replaceChildren(); return; }
  const total = tally.stuck.reduce((sum, r) => sum + r.count, 0);
  rejected = new Map(tally.stuck.filter(r => r.line && r.file === given.file).map(r => [r.line, r.count / total]));
  margin();
  at("tally").replaceChildren(tallyShown(tally), softShown(tally), ...printedShown());
}

function tallyShown(tally, what = "scene") {
  const total = tally.stuck.reduce((sum, r) => sum + r.count, 0), panel = make("div", {class: "panel"});
  const found = tally.scenes ?? tally.runs;
  panel.append(make("h2", {}, `${plural(found, what)} in ${plural(tally.attempts, "attempt")}`));
  if (tally.coins) panel.append(make("p", {}, "Coins are thrown once for a scene (reading soft=scene): the attempts do not tell how likely a run is accepted."));
  else if (tally.acceptance) {
    const [p, low, high] = tally.acceptance;
    panel.append(make("p", {}, `A run is accepted with probability ${percent(p)} or so: between ${percent(low)} and ${percent(high)}, with ${percent(tally.level)} confidence.`));
  }
  if (!total) { panel.append(make("p", {class: "dim"}, tally.attempts ? "No attempt was rejected." : "No attempt was made.")); return panel; }
  const rows = tally.stuck.map(r => make(
    "tr", {}, make("td", {class: "number"}, r.count.toLocaleString("en")), make("td", {class: "number"}, percent(r.count / total)), make("td", {}, bar(r.count / total)),
    make("td", {}, r.line && r.file === given.file ? make("button", {class: "link", onclick: () => select(r)}, r.text) : r.text, r.among > 1 ? ` (and ${r.among - 1} like it)` : "", sourceLine(r)),
  ));
  panel.append(make("table", {}, make("thead", {}, make("tr", {}, make("th", {class: "number"}, "rejected"), make("th", {class: "number"}, "share"), make("th"), make("th", {}, "what failed first"))), make("tbody", {}, ...rows)));
  return panel;
}

function bar(share) { const made = make("span", {class: "share"}); made.style.width = `${Math.max(2, 110 * share)}px`; return made; }

function sourceLine(place) {
  if (!place.line) return null;
  const line = place.file === given.file ? (program.value.split("\n")[place.line - 1] || "").trim() : "";
  return make("div", {class: "code dim"}, `${place.file}:${place.line}${line ? `: ${clipped(line, 100)}` : ""}`);
}

function softShown(tally) {
  const shown = make("div");
  for (const soft of tally.soft || []) {
    const note = soft.held < soft.probability * soft.known ? " Its coin is thrown in every attempt, stuck ones included (reading soft=run)." : "";
    shown.append(make("div", {class: "panel"}, make("p", {}, `This soft requirement asks for ${percent(soft.probability, 0)}; its condition held in ${soft.held} of ${plural(soft.known, "scene")} (${percent(soft.held / soft.known, 0)}).${note}`), sourceLine(soft)));
  }
  return shown;
}

function printedShown() {
  const p = state.printed;
  if (!p) return [];
  return [make("div", {class: "panel"}, make("h2", {}, `Printed in ${p.scene === null ? "the attempt that failed" : `scene ${p.scene}`}`), ...p.lines.map(line => make("div", {class: "code"}, line)))];
}
