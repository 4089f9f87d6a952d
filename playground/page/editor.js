// The program: colours, marks below it, the margin, and what is wrong.

const program = at("program");
const kinds = [];  // what the lexer has: neighbouring patterns of one kind are one
for (const [pattern, kind] of given.rules) {
  const last = kinds[kinds.length - 1];
  if (last && typeof kind === "string" && last[1] === kind) last[0] += `|(?:${pattern})`;
  else kinds.push([typeof kind === "string" ? `(?:${pattern})` : pattern, kind]);
}
for (const one of kinds) one[0] = new RegExp(one[0], "uym");
const words = new Set(given.rules.flatMap(([pattern]) => pattern.match(/[A-Za-z_]+/g) || []));
const NAME = /[\p{L}_][\p{L}\p{N}_]*/uy;  // one that stands in no pattern, and is not the beginning of a text, is a name
const STRANGE = /[\u0000-\u0008\u000b-\u001f\u007f-\u009f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069]/;
const LARGEST_COLOURED = 60000;
let problems = [], nowAt = null, rejected = new Map();

// The pieces of a text, each with the class of its colour: what the lexer of Pygments says.
function* pieces(text) {
  let place = 0;
  while (place < text.length) {
    NAME.lastIndex = place;
    const name = NAME.exec(text);
    if (name && !words.has(name[0]) && !"\"'".includes(text[place + name[0].length] || " ")) { yield [name[0], "n"]; place += name[0].length; continue; }
    let found = null, kind = "";
    for (const [pattern, kindOf] of kinds) {
      pattern.lastIndex = place;
      found = pattern.exec(text);
      if (found && found[0]) { kind = kindOf; break; }
    }
    if (!found || !found[0]) { const letter = String.fromCodePoint(text.codePointAt(place)); yield [letter, ""]; place += letter.length; continue; }
    if (Array.isArray(kind)) for (let i = 0; i < kind.length; i++) yield [found[i + 1], kind[i]];
    else yield [found[0], kind];
    place += found[0].length;
  }
}

// What was last seen of the text, and which of its rows are drawn: those in view and some around them, since thousands would take seconds.
const seen = {text: null, rows: [""], starts: [0, 1], cells: [], first: 0, last: 0};
const ROW = 20, AROUND = 60;

function look() {
  if (program.value === seen.text) return;
  seen.text = program.value;
  seen.rows = seen.text.split("\n");
  seen.starts = [0];
  for (const row of seen.rows) seen.starts.push(seen.starts[seen.starts.length - 1] + row.length + 1);
  seen.last = Math.min(seen.last, seen.rows.length);
  seen.first = Math.min(seen.first, seen.last);
  seen.cells = seen.text.length > LARGEST_COLOURED ? [[seen.text, ""]] : [...pieces(seen.text)];
}

function inView() {
  const top = Math.floor(program.scrollTop / ROW), bottom = Math.ceil((program.scrollTop + program.clientHeight) / ROW);
  return [Math.min(Math.max(0, top), seen.rows.length - 1), Math.min(bottom, seen.rows.length)];
}

function colour() {
  look();
  const [top, bottom] = inView();
  seen.first = Math.max(0, top - AROUND);
  seen.last = Math.min(seen.rows.length, bottom + AROUND);
  drawColours();
  drawMarks();
  drawMargin();
  follow();
}

function mark() { look(); drawMarks(); follow(); }
function margin() { look(); drawMargin(); follow(); }

// The rows that are drawn, from one place in the text to another.
function stretch() { return [seen.starts[seen.first], Math.min(seen.starts[seen.last], seen.text.length)]; }

function drawColours() {
  const [from, to] = stretch(), shown = make("div", {});
  const strange = piece => piece.split(/([\u0000-\u0008\u000b-\u001f\u007f-\u009f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069])/).filter(part => part).map(part => STRANGE.test(part) ? make("span", {class: "odd"}, part) : part);
  let place = 0;
  for (const [whole, kind] of seen.cells) {
    if (!whole) continue;
    const piece = whole.slice(Math.max(0, from - place), Math.max(0, to - place));
    place += whole.length;
    if (!piece) { if (place > to) break; continue; }
    const parts = seen.text.length <= LARGEST_COLOURED && STRANGE.test(piece) ? strange(piece) : [piece];
    if (kind && kind !== "w" && kind !== "p") shown.append(make("span", {class: kind}, ...parts)); else shown.append(...parts);
  }
  at("colours").replaceChildren(shown);
}

function drawMargin() {
  const worst = new Map(), shown = make("div", {});
  for (const p of problems) if (p.line && p.file === given.file && worst.get(p.line) !== "error") worst.set(p.line, p.severity);
  for (let i = seen.first; i < seen.last; i++) {
    const share = rejected.get(i + 1), row = make("div", {class: worst.get(i + 1) || ""});
    if (share) { const badge = make("b", {title: `${percent(share)} of the rejected attempts failed here`}, share < .005 ? "<1%" : `${Math.round(100 * share)}%`); row.append(badge); }
    row.append(String(i + 1));
    shown.append(row);
  }
  at("gutter").style.minWidth = `calc(${String(seen.rows.length).length}ch + ${rejected.size ? 62 : 14}px)`;  // whatever is in view
  at("gutter").replaceChildren(shown);
}

// The place of a line and a column, both counted from 1, columns in characters, in the text.
function offset(line, column) {
  look();
  if (line > seen.rows.length) return seen.text.length;
  const row = seen.rows[line - 1], from = line === 1 && row.startsWith("\uFEFF") ? 1 : 0;
  return seen.starts[line - 1] + Array.from(row.slice(from)).slice(0, column - 1).join("").length + from;
}

function rangeOf(place) {
  const end = place.endLine ?? place.end_line, last = place.endColumn ?? place.end_column;
  const from = offset(place.line, place.column);
  return [from, Math.max(from + 1, offset(end, last))];
}

function drawMarks() {
  const [from, to] = stretch(), text = seen.text, shown = make("div", {});
  const ranges = problems.filter(p => p.line && p.file === given.file).map(p => [...rangeOf(p), p.severity]);
  if (nowAt && nowAt.line && nowAt.file === given.file) ranges.push([...rangeOf(nowAt), "now"]);
  const inside = ranges.filter(([a, b]) => a <= to && from <= b), cuts = [...new Set([from, to, ...inside.flatMap(([a, b]) => [a, b])])].filter(x => from <= x && x <= to).sort((a, b) => a - b);
  for (let i = 0; i + 1 < cuts.length; i++) {
    const kindsHere = inside.filter(([a, b]) => a <= cuts[i] && cuts[i] < b).map(r => r[2]), piece = text.slice(cuts[i], cuts[i + 1]);
    shown.append(kindsHere.length ? make("span", {class: kindsHere.join(" ")}, piece.replace(/\n/g, " \n")) : piece);
  }
  const beyond = inside.find(([, b]) => b > text.length);
  if (beyond) shown.append(make("span", {class: beyond[2]}, "  "));
  at("marks").replaceChildren(shown);
}

// The layers go with the text, and are drawn anew where it was scrolled beyond what is drawn.
function follow() {
  const [top, bottom] = inView();
  if (top < seen.first || bottom > seen.last) { colour(); return; }
  const down = seen.first * ROW - program.scrollTop;
  for (const layer of [at("colours"), at("marks")]) if (layer.firstChild) layer.firstChild.style.transform = `translate(${-program.scrollLeft}px, ${down}px)`;
  if (at("gutter").firstChild) at("gutter").firstChild.style.transform = `translateY(${down}px)`;
}

function reveal(line) {
  const top = (line - 1) * 20, height = program.clientHeight;
  if (top < program.scrollTop || top > program.scrollTop + height - 60) program.scrollTop = Math.max(0, top - height / 3);
  follow();
}

function select(place) {
  if (!place.line || place.file !== given.file) return;
  const [from, to] = rangeOf(place);
  program.focus();
  program.setSelectionRange(from, Math.min(to, program.value.length));
  reveal(place.line);
}

function showProblems(found, notes = []) {
  problems = found;
  at("problems").replaceChildren(
    ...found.map(p => make(
      "button", {class: p.severity, onclick: () => select(p)}, make("b", {}, p.line ? `${p.severity}, ${p.file === given.file ? "" : `${p.file}, `}line ${p.line}: ` : `${p.severity}: `),
      p.message, p.hint ? make("span", {class: "hint"}, p.hint) : null, p.expected && p.expected.length ? make("span", {class: "hint"}, `expected: ${p.expected.join(", ")}`) : null,
    )),
    ...notes.map(note => make("button", {class: "note"}, make("b", {}, "note: "), note)),
  );
  mark();
  margin();
}

// Typing

let leaving = false;
program.addEventListener("keydown", event => {
  if (event.key === "Escape") { leaving = true; return; }
  const plain = !event.ctrlKey && !event.metaKey && !event.altKey;
  const {selectionStart: from, selectionEnd: to, value} = program;
  const begin = value.lastIndexOf("\n", from - 1) + 1;
  if (event.key === "Tab" && plain && !leaving) {
    event.preventDefault();
    if (event.shiftKey || value.slice(from, to).includes("\n")) {
      const lines = value.slice(begin, to).split("\n").map(l => event.shiftKey ? l.replace(/^ {1,4}/, "") : l ? "    " + l : l).join("\n");
      program.setSelectionRange(begin, to);
      document.execCommand("insertText", false, lines);
      program.setSelectionRange(begin, begin + lines.length);
    } else document.execCommand("insertText", false, " ".repeat(4 - (from - begin) % 4));
  } else if (event.key === "Enter" && plain && !event.shiftKey) {
    event.preventDefault();
    const line = value.slice(begin, from), indent = line.match(/^[ \t]*/)[0];
    document.execCommand("insertText", false, "\n" + indent + (/:\s*(#.*)?$/.test(line) ? "    " : ""));
  }
  leaving = false;
});
program.addEventListener("scroll", follow);
new ResizeObserver(follow).observe(program);
program.addEventListener("input", () => { edited(); });
