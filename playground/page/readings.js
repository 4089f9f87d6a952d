// Readings as switches, which of them change something, and the scenes under both answers side by side.

const surveyed = new Map();
let surveyedAt = -1;

function showReadings() {
  const words = at("find").value.trim().toLowerCase(), list = at("reading-list");
  const rank = r => (state.readings[r.id] !== defaults[r.id] ? 0 : surveyed.has(r.id) && [...surveyed.get(r.id).values()].some(changes) ? 1 : 2);
  const found = given.readings.filter(r => !words || `${r.id} ${r.question} ${Object.values(r.alternatives).join(" ")} ${r.consequence}`.toLowerCase().includes(words));
  found.sort((a, b) => rank(a) - rank(b));
  list.replaceChildren(...found.map(readingRow));
  if (!found.length) list.append(make("p", {class: "dim"}, "No reading has these words."));
  at("switched").textContent = switchedReadings().length || "";
}

const changes = found => found.error !== undefined || found.changed.length > 0;

function readingRow(r) {
  const choice = make("select", {"aria-label": `The answer to: ${r.question}`, onchange: event => switchTo(r.id, event.target.value)}, ...Object.keys(r.alternatives).map(a => new Option(a + (a === defaults[r.id] ? " (default)" : ""), a, false, a === state.readings[r.id])));
  choice.id = `reading-${r.id}`;
  const badges = [...(surveyed.get(r.id) || new Map())].map(([answer, found]) => {
    const said = found.error !== undefined ? `${answer}: ${found.error}` : found.changed.length ? `${answer}: changes ${found.changed.length} of ${plural(found.of, "scene")}: ${found.what.join(", ")}` : `${answer}: nothing here`;
    return make("span", {class: changes(found) ? "badge yes" : "badge", title: said}, clipped(said, 80));
  });
  const means = r.alternatives[state.readings[r.id]];
  return make(
    "div", {class: state.readings[r.id] !== defaults[r.id] ? "reading switched" : "reading"}, make("code", {title: r.places.join("\n")}, r.id),
    make("span", {}, r.question, r.about === "policy" ? make("span", {class: "dim"}, " (simulations)") : null), choice,
    make("div", {class: "means"}, means ? `${state.readings[r.id]}: ${means}. ` : "", r.consequence, " ", ...badges),
  );
}

function switchTo(id, answer) {
  state.readings[id] = answer;
  changed(0);
  showReadings();
  const focus = at(`reading-${id}`);
  if (focus) focus.focus();
}

function compare() {
  const shown = at("compared"), switched = switchedReadings();
  if (!switched.length) { shown.replaceChildren(); return; }
  const title = switched.map(r => `${r.id}=${state.readings[r.id]}`).join(", "), before = switched.map(r => `${r.id}=${defaults[r.id]}`).join(", ");
  const count = Math.max(state.scenes.length, state.base.length), differ = [];
  const pairs = Array.from({length: count}, (_, i) => {
    const one = state.base[i], other = state.scenes[i], isOther = one && other && one.digest !== other.digest;
    if (isOther) differ.push(i);
    const side = (scene, name) => make("figure", {}, scene ? drawScene(scene) : make("p", {class: "dim"}, "no scene"), make("figcaption", {}, scene ? `${name}, ${plural(scene.attempts, "attempt")}` : name));
    return make("div", {class: isOther ? "pair changed" : "pair"}, make("p", {}, make("b", {}, `scene ${i}`), one && other ? (isOther ? `: ${difference(one, other)}` : ": the same") : ""), side(one, "default"), side(other, "switched"));
  });
  const took = tally => tally ? tally.attempts.toLocaleString("en") : "?";
  shown.replaceChildren(
    make("div", {class: "panel"}, make("h2", {}, `${title}, beside ${before}`), make("p", {}, `${differ.length} of ${plural(count, "scene")} differ. They took ${took(state.baseTally)} attempts by default, and ${took(state.tally)} now.` + (state.baseProblem ? ` By default: ${state.baseProblem}` : ""))),
    make("div", {class: "pairs"}, ...pairs),
  );
}

// In a few words what is different in two scenes: the attempts, or the first properties that are.
function difference(one, other) {
  if (one.objects.length !== other.objects.length) return `${plural(one.objects.length, "object")} and ${other.objects.length}`;
  const found = [];
  for (const name of new Set([...Object.keys(one.params), ...Object.keys(other.params)])) if (told(one.params[name]) !== told(other.params[name])) found.push(`param ${name} ${told(one.params[name])} → ${told(other.params[name])}`);
  one.objects.forEach((o, i) => {
    const p = other.objects[i], all = x => ({position: x.position, heading: x.heading, width: x.width, length: x.length, ...x.properties}), a = all(o), b = all(p);
    for (const name of new Set([...Object.keys(a), ...Object.keys(b)])) if (told(a[name]) !== told(b[name])) found.push(`${nameOf(o, one.ego)}.${name} ${told(a[name])} → ${told(b[name])}`);
  });
  const first = found.slice(0, 2).map(f => clipped(f, 90)).join("; ");
  return first ? first + (found.length > 2 ? `; ${found.length - 2} more` : "") : "another order";
}

at("find").oninput = showReadings;
at("reset").onclick = () => { Object.assign(state.readings, defaults); changed(0); showReadings(); };
at("survey").onclick = () => {
  surveyed.clear();
  surveyedAt = state.version;
  say("reading-message", "Every other answer is tried on the first scenes…");
  showReadings();
  ask("survey", "survey", {count: 6}, found => {
    if (found.kind === "survey") {
      if (!surveyed.has(found.reading)) surveyed.set(found.reading, new Map());
      surveyed.get(found.reading).set(found.answer, found);
    } else if (messageOf(found)) say("reading-message", messageOf(found), true);
    else if (found.kind === "done") {
      const which = [...surveyed].filter(([, answers]) => [...answers.values()].some(changes)).map(([id]) => id);
      if (!at("reading-message").classList.contains("bad")) say("reading-message", which.length ? `${plural(which.length, "reading")} would change scenes of this program: ${which.join(", ")}.` : "No other answer changes the first scenes of this program.");
      showReadings();
    }
  });
};
