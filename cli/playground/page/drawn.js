// Scenes as pictures: seen from above, North is up. Coordinates are numbers, texts are text nodes.

const SIZE = 240;
const classes = new Map();  // the colour of each class of objects, in the order in which they come

function colourOf(o, ego) {
  if (o.id === ego) return "is-ego";
  if (!classes.has(o.class)) classes.set(o.class, classes.size % 6);
  return `o${classes.get(o.class)}`;
}

function frame(window, width, height) {
  const [west, south, east, north] = window, scale = Math.min(width / (east - west), height / (north - south));
  const x0 = (west + east) / 2, y0 = (south + north) / 2;
  return {scale, width, height, X: x => width / 2 + (x - x0) * scale, Y: y => height / 2 - (y - y0) * scale};
}

const pathOf = (points, f, closed = true) => points.map(([x, y], i) => `${i ? "L" : "M"}${f.X(x).toFixed(1)} ${f.Y(y).toFixed(1)}`).join("") + (closed ? "Z" : "");
const isColour = text => /^#[0-9a-f]{6}$/i.test(text);

function groundOf(ground, f) {
  const group = svg("g", {class: "ground"});
  for (const area of (ground && ground.areas) || []) {
    const d = area.rings.map(ring => pathOf(ring, f)).join("");
    if (isColour(area.colour) && isColour(area.edge)) group.append(svg("path", {d, fill: area.colour, stroke: area.edge, "stroke-width": .7, "fill-rule": "evenodd"}));
  }
  for (const line of (ground && ground.lines) || []) {
    if (isColour(line.colour)) group.append(svg("path", {d: pathOf(line.points, f, false), fill: "none", stroke: line.colour, "stroke-width": 1.6}));
  }
  for (const some of (ground && ground.points) || []) {
    if (isColour(some.colour)) group.append(...some.points.map(([x, y]) => svg("circle", {cx: f.X(x).toFixed(1), cy: f.Y(y).toFixed(1), r: 2, fill: some.colour})));
  }
  if (ground && ground.ways && isColour(ground.ink)) {
    group.append(svg("path", {d: ground.ways.map(way => pathOf(way, f, false)).join(""), fill: "none", stroke: ground.ink, "stroke-width": .6, opacity: .6}));
    const half = ground.length * f.scale / 2;
    const arrows = ground.arrows.map(([x, y, heading]) => {
      const sin = Math.sin(heading), cos = Math.cos(heading), cx = f.X(x), cy = f.Y(y);
      const point = (right, ahead) => `${(cx + right * cos - ahead * sin).toFixed(1)} ${(cy - right * sin - ahead * cos).toFixed(1)}`;
      return `M${point(0, -half)}L${point(0, half)}M${point(-half * .4, half * .4)}L${point(0, half)}L${point(half * .4, half * .4)}`;
    });
    group.append(svg("path", {d: arrows.join(""), fill: "none", stroke: ground.ink, "stroke-width": .9, opacity: .75}));
  }
  return group;
}

// The box of an object with a triangle at its front; a dot where the box would not be seen.
function thing(o, ego, f) {
  const [x, y] = o.position, group = svg("g"), kind = `thing ${colourOf(o, ego)}`, sin = Math.sin(o.heading), cos = Math.cos(o.heading);
  const cx = f.X(x), cy = f.Y(y), w = o.width * f.scale / 2, l = o.length * f.scale / 2;
  const point = (right, ahead) => `${(cx + right * cos - ahead * sin).toFixed(2)},${(cy - right * sin - ahead * cos).toFixed(2)}`;
  if (Math.max(w, l) < 2.5) group.append(svg("circle", {cx, cy, r: 3, class: kind}));
  else {
    group.append(svg("polygon", {points: [point(-w, -l), point(w, -l), point(w, l), point(-w, l)].join(" "), class: kind}));
    const tip = Math.min(w * .7, l * .7, 7);
    group.append(svg("polygon", {points: [point(0, l * .92), point(tip, l * .92 - 1.5 * tip), point(-tip, l * .92 - 1.5 * tip)].join(" "), class: "front"}));
  }
  group.append(svg("title", {}, sentence(o, ego)));
  return group;
}

function nameOf(o, ego) { return o.name || (o.id === ego ? "ego" : o.class); }

function sentence(o, ego) {
  return `${nameOf(o, ego)} (${o.class}, object ${o.id}) at (${o.position.map(number).join(", ")}), heading ${number(o.heading * 180 / Math.PI)}°`;
}

function labels(objects, ego, f) {
  const group = svg("g"), taken = [], crowded = objects.length > 8;
  for (const o of objects) {
    if (crowded && !o.name) continue;
    const sin = Math.abs(Math.sin(o.heading)), cos = Math.abs(Math.cos(o.heading)), half = (o.length * cos + o.width * sin) / 2 * f.scale;
    const x = f.X(o.position[0]), below = f.Y(o.position[1]) + half + 11, above = f.Y(o.position[1]) - half - 4;
    const free = y => taken.every(([a, b]) => Math.abs(y - b) > 10 || Math.abs(x - a) > 42) && y < f.height - 3 && y > 9;
    const y = [below, below + 11, above, above - 11].find(free) ?? below;
    taken.push([x, y]);
    group.append(svg("text", {x: Math.min(Math.max(x, 16), f.width - 16), y, class: "label"}, clipped(nameOf(o, ego), 22)));
  }
  return group;
}

function scaleBar(f) {
  const most = f.width / 4 / f.scale, power = 10 ** Math.floor(Math.log10(most)), metres = [5, 2, 1].map(s => s * power).find(m => m <= most * (1 + 1e-9)) || power;
  const x = f.width * .04, y = f.height * .96;
  return svg("g", {}, svg("line", {x1: x, x2: x + metres * f.scale, y1: y, y2: y, class: "scale"}), text(x + metres * f.scale / 2, y - 5, `${number(metres)} m`));
}

function text(x, y, words, kind = "label") { return svg("text", {x, y, class: kind}, words); }

function drawScene(scene, size = SIZE) {
  const about = `Scene ${scene.scene} of seed ${scene.seed}: ` + (scene.problem || scene.objects.slice(0, 8).map(o => sentence(o, scene.ego)).join("; "));
  const root = svg("svg", {class: "scene", viewBox: `0 0 ${size} ${size}`, role: "img", "aria-label": about});
  if (scene.problem) { root.append(text(size / 2, size / 2, clipped(scene.problem, 40))); return root; }
  const f = frame(scene.window, size, size);
  root.append(groundOf(scene.ground, f));
  if (scene.view.length) root.append(svg("path", {d: pathOf(scene.view, f), class: scene.allSeen ? "view all" : "view"}));
  root.append(...scene.objects.map(o => thing(o, scene.ego, f)), labels(scene.objects, scene.ego, f), scaleBar(f));
  return root;
}
