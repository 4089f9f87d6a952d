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

// The names and directions of the features of a map of one's own.
function marksOf(marks, f) {
  return svg("g", {}, ...marks.map(({text: words, at, ahead: [east, north]}) => {
    if (words) return text(f.X(at[0]), f.Y(at[1]) + 3, words, "label mark");
    const [x, y] = [east * f.scale, -north * f.scale], [cx, cy] = [f.X(at[0]), f.Y(at[1])];
    const point = (ahead, left) => `${(cx + ahead * x + left * y).toFixed(1)} ${(cy + ahead * y - left * x).toFixed(1)}`;
    return svg("path", {d: `M${point(-1, 0)}L${point(1, 0)}M${point(.4, .4)}L${point(1, 0)}L${point(.4, -.4)}`, class: "way"});
  }));
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

// The name of each object below or above its box, wherever it lies on fewest of the other boxes and names.
function labels(objects, ego, f) {
  const group = svg("g"), crowded = objects.length > 8, taken = objects.map(o => boxOf(o, f));
  objects.forEach((o, own) => {
    if (crowded && !o.name) return;
    const words = clipped(nameOf(o, ego), 22), [, top, , bottom] = taken[own], half = 3 * words.length;
    const x = Math.min(Math.max(f.X(o.position[0]), 16), f.width - 16), box = y => [x - half, y - 9, x + half, y + 2];
    const over = y => taken.filter((other, i) => i !== own && overlap(box(y), other)).length + (y > f.height - 3 || y < 9 ? taken.length : 0);
    const places = [bottom + 11, bottom + 22, top - 4, top - 15], least = Math.min(...places.map(over)), y = places.find(y => over(y) === least);
    taken.push(box(y));
    group.append(text(x, y, words));
  });
  return group;
}

// West, top, east and bottom of the box of an object.
function boxOf(o, f) {
  const sin = Math.abs(Math.sin(o.heading)), cos = Math.abs(Math.cos(o.heading)), [x, y] = [f.X(o.position[0]), f.Y(o.position[1])];
  const across = (o.length * sin + o.width * cos) / 2 * f.scale, along = (o.length * cos + o.width * sin) / 2 * f.scale;
  return [x - across, y - along, x + across, y + along];
}

const overlap = (a, b) => a[0] < b[2] && b[0] < a[2] && a[1] < b[3] && b[1] < a[3];

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
  if (scene.ground.marks) root.append(marksOf(scene.ground.marks, f));
  root.append(...scene.objects.map(o => thing(o, scene.ego, f)), labels(scene.objects, scene.ego, f), scaleBar(f));
  return root;
}
