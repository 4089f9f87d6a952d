// Histograms of a property, a relation or an expression, and the exact law beside the bars where the program is finite.

const counted = {values: [], law: null, what: null, unit: ""};
const MOST_BARS = 24, BINS = 24;

function featureTitle(name) {
  const found = name.match(/^objects\[(\d+)\]\.(?:properties\.)?(.+)$/);
  if (found) return `${state.names[found[1]] || "object"} (${found[1]}): ${found[2].replace("position[0]", "position.x").replace("position[1]", "position.y")}`;
  const relation = name.match(/^(distance|bearing|relativeHeading)\((\d+), (\d+)\)$/);
  if (relation) return `${relation[1]} of ${state.names[relation[3]] || ""} (${relation[3]}) from ${state.names[relation[2]] || ""} (${relation[2]})`;
  return name.startsWith("params.") ? `param ${name.slice(7)}` : name;
}

function showFeatures() {
  const changing = make("optgroup", {label: "what differs from scene to scene"}), same = make("optgroup", {label: "what was the same in the scenes drawn"});
  const late = f => ["attempts", "objects", "ego"].includes(f.name) ? 1 : 0;
  for (const f of [...state.features].sort((a, b) => late(a) - late(b))) (f.varies ? changing : same).append(new Option(featureTitle(f.name), f.name));
  at("feature").replaceChildren(...[changing, same].filter(group => group.children.length));
  if (state.features.some(f => f.name === wantedFeature)) at("feature").value = wantedFeature;
  if (state.tab === "histogram") histogramIfNeeded();
}

let counting = "", wantedFeature = "";

function histogramIfNeeded() {
  const expression = at("expression").value.trim(), feature = at("feature").value;
  if (!expression && !feature) { at("chart").hidden = true; return; }
  const key = JSON.stringify([state.version, expression, expression ? "" : feature, at("values").value]);
  if (key === counting) return;
  counting = key;
  askHistogram(expression, feature);
}

function askHistogram(expression, feature) {
  const what = expression ? {expression} : {feature}, count = Number(at("values").value);
  counted.values = []; counted.law = null; counted.what = expression || featureTitle(feature);
  counted.unit = expression ? "" : state.features.find(f => f.name === feature)?.unit || "";
  say("histogram-message", "");
  at("chart").hidden = true;
  ask("histogram", "histogram", {count, ...what}, found => {
    if (found.kind === "values") { counted.values.push(...found.values); showHistogram(); }
    else if (messageOf(found)) say("histogram-message", messageOf(found), true);
  });
  ask("law", "law", what, found => {
    if (found.kind === "law") { counted.law = found; showHistogram(); }
    else if (found.kind === "nolaw") { counted.law = {why: found.why}; showHistogram(); }
    else if (messageOf(found)) { counted.law = {why: messageOf(found)}; showHistogram(); }
  });
}

// The bars: a label, how many scenes, and the exact probability with its fraction (undefined where none is known).
function barsOf(values, law) {
  const exact = law && law.law ? law.law : [];
  const numbers = [...values, ...exact.map(e => e.value)].every(v => typeof v === "number");
  const keyOf = v => JSON.stringify(v), counts = new Map();
  for (const v of values) counts.set(keyOf(v), (counts.get(keyOf(v)) || 0) + 1);
  for (const e of exact) if (!counts.has(keyOf(e.value))) counts.set(keyOf(e.value), 0);
  if (numbers && counts.size > MOST_BARS) {
    const all = [...values, ...exact.map(e => e.value)], low = Math.min(...all), high = Math.max(...all), wide = (high - low) / BINS || 1;
    const place = v => Math.min(BINS - 1, Math.max(0, Math.floor((v - low) / wide)));
    const bars = Array.from({length: BINS}, (_, i) => ({from: low + i * wide, label: `${number(low + i * wide)} to ${number(low + (i + 1) * wide)}`, count: 0}));
    for (const v of values) bars[place(v)].count++;
    if (exact.length && exact.length === law.values) { for (const b of bars) b.exact = 0; for (const e of exact) bars[place(e.value)].exact += e.approximately; }
    return {bars, binned: true, low, high};
  }
  const known = new Map(exact.map(e => [keyOf(e.value), e]));
  const bars = [...counts].map(([key, count]) => ({value: JSON.parse(key), label: labelOf(JSON.parse(key)), count, exact: law && law.law ? known.get(key)?.approximately ?? 0 : undefined, fraction: known.get(key)?.probability}));
  bars.sort(numbers ? (a, b) => a.value - b.value : (a, b) => (b.exact ?? 0) - (a.exact ?? 0) || b.count - a.count);
  const rest = bars.splice(MOST_BARS);
  if (rest.length) bars.push({label: `${rest.length} others`, count: rest.reduce((s, b) => s + b.count, 0), exact: law && law.law ? rest.reduce((s, b) => s + b.exact, 0) : undefined});
  return {bars, binned: false};
}

const labelOf = value => value === null ? "(none)" : typeof value === "number" ? number(value) : typeof value === "boolean" ? (value ? "True" : "False") : value;

function showHistogram() {
  const {values, law, what, unit} = counted, n = values.length;
  if (!n) return;
  const {bars, binned, low, high} = barsOf(values, law), highest = Math.max(...bars.map(b => Math.max(b.count / n, b.exact ?? 0))) || 1;
  const width = 640, left = 44, slanted = !binned && (bars.length > 12 || bars.some(b => b.label.length * bars.length > 90)), below = slanted ? 64 : 26, bottom = below + (unit ? 16 : 0), height = 240 + bottom - below, top = 12, wide = (width - left - 8) / bars.length, tall = height - top - bottom;
  const Y = share => top + tall * (1 - share / highest);
  const chart = svg("svg", {viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": `Histogram of ${what} in ${n} scenes; the table below has the figures`});
  for (const share of [0, highest / 2, highest]) chart.append(svg("line", {x1: left, x2: width - 8, y1: Y(share), y2: Y(share), class: "axis"}), svg("text", {x: left - 5, y: Y(share) + 4, "text-anchor": "end", class: "tick"}, percent(share, highest < .1 ? 1 : 0)));
  bars.forEach((b, i) => {
    const x = left + i * wide, gap = binned ? .5 : Math.min(6, wide * .15), y = Y(b.count / n);
    const shape = svg("rect", {x: x + gap, y, width: Math.max(.5, wide - 2 * gap), height: Math.max(0, Y(0) - y), class: "bar"});
    shape.append(svg("title", {}, `${b.label}: ${plural(b.count, "scene")}, ${percent(b.count / n)}` + (b.exact !== undefined ? `; exactly ${b.fraction || percent(b.exact, 3)}` : "")));
    chart.append(shape);
    if (b.exact !== undefined) chart.append(svg("line", {x1: x + gap, x2: x + wide - gap, y1: Y(b.exact), y2: Y(b.exact), class: "law"}));
    if (!binned) {
      const middle = x + wide / 2, y0 = height - bottom + 14;
      chart.append(svg("text", slanted ? {x: middle, y: y0, "text-anchor": "end", transform: `rotate(-35 ${middle} ${y0})`} : {x: middle, y: y0, "text-anchor": "middle"}, clipped(b.label, slanted ? 13 : 15)));
      if (b.fraction && b.fraction.length < 12 && wide > 34) chart.append(svg("text", {x: middle, y: Math.min(Y(b.exact), Y(b.count / n)) - 4, "text-anchor": "middle"}, b.fraction));
    }
  });
  if (binned) for (const share of [0, .25, .5, .75, 1]) chart.append(svg("text", {x: left + (width - left - 8) * share, y: height - bottom + 18, "text-anchor": share === 0 ? "start" : share === 1 ? "end" : "middle", class: "tick"}, number(low + (high - low) * share)));
  if (unit) chart.append(svg("text", {x: left + (width - left - 8) / 2, y: height - 4, "text-anchor": "middle", class: "tick"}, `in ${unit}`));
  const legend = make("div", {class: "legend"}, make("span", {}, make("i"), `share of ${plural(n, "scene")}`));
  if (law && law.law) legend.append(make("span", {}, make("i", {class: "law"}), `the exact law (${plural(law.runs, "run")}); a run is accepted with probability ${clipped(law.acceptance, 30)}`));
  else if (law) legend.append(make("span", {}, `No exact law: ${law.why}`));
  const numbers = values.filter(v => typeof v === "number");
  if (numbers.length === n) { const mean = numbers.reduce((a, b) => a + b, 0) / n; legend.append(make("span", {}, `mean ${number(mean)}, standard deviation ${number(Math.sqrt(numbers.reduce((a, b) => a + (b - mean) ** 2, 0) / Math.max(1, n - 1)))}`)); }
  const rows = bars.map(b => make("tr", {}, make("td", {class: "code"}, b.label), make("td", {class: "number"}, b.count.toLocaleString("en")), make("td", {class: "number"}, percent(b.count / n)), ...(law && law.law ? [make("td", {class: "number"}, b.fraction || ""), make("td", {class: "number"}, b.exact === undefined ? "" : percent(b.exact, 3))] : [])));
  const heads = ["value", "scenes", "share", ...(law && law.law ? ["exactly", ""] : [])];
  const shown = at("figures") ? !at("figures").hidden : !binned;
  const table = make("table", {id: "figures"}, make("thead", {}, make("tr", {}, ...heads.map((h, i) => make("th", {class: i ? "number" : ""}, h)))), make("tbody", {}, ...rows));
  const more = make("button", {class: "more", "aria-controls": "figures", onclick: () => unfold(more, at("figures").hidden)}, "The figures");
  at("chart").replaceChildren(make("h2", {class: "code"}, what), chart, legend, more, table);
  unfold(more, shown);
  at("chart").hidden = false;
}

at("feature").onchange = () => { wantedFeature = at("feature").value; at("expression").value = ""; histogramIfNeeded(); };
at("values").onchange = histogramIfNeeded;
at("relation").onsubmit = event => { event.preventDefault(); histogramIfNeeded(); };
