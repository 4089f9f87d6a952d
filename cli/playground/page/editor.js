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

function colour() {
  const text = program.value, shown = document.createDocumentFragment();
  const strange = piece => piece.split(/([\u0000-\u0008\u000b-\u001f\u007f-\u009f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069])/).filter(part => part).map(part => STRANGE.test(part) ? make("span", {class: "odd"}, part) : part);
  if (text.length > LARGEST_COLOURED) shown.append(text);
  else for (const [piece, kind] of pieces(text)) {
    const parts = STRANGE.test(piece) ? strange(piece) : [piece];
    if (kind && kind !== "w" && kind !== "p") shown.append(make("span", {class: kind}, ...parts)); else shown.append(...parts);
  }
  shown.append("\n ");
  at("colours").replaceChildren(shown);
  margin();
  follow();
}

function margin() {
  const lines = program.value.split("\n").length, worst = new Map();
  for (const p of problems) if (p.line && p.file === given.file && worst.get(p.line) !== "error") worst.set(p.line, p.severity);
  at("gutter").replaceChildren(...Array.from({length: Math.min(lines, 20000)}, (_, i) => {
    const share = rejected.get(i + 1), row = make("div", {class: worst.get(i + 1) || ""});
    if (share) { const badge = make("b", {title: `${percent(share)} of the rejected attempts failed here`}, share < .005 ? "<1%" : `${Math.round(100 * share)}%`); row.append(badge); }
    row.append(String(i + 1));
    return row;
  }));
}

// The place of a line and a column, both counted from 1, columns in characters, in the text.
function offset(line, column) {
  const lines = program.value.split("\n");
  if (line > lines.length) return program.value.length;
  const before = lines.slice(0, line - 1).reduce((sum, l) => sum + l.length + 1, 0);
  const from = line === 1 && lines[0].startsWith("\uFEFF") ? 1 : 0;
  return before + Array.from(lines[line - 1].slice(from)).slice(0, column - 1).join("").length + from;
}

function rangeOf(place) {
  const end = place.endLine ?? place.end_line, last = place.endColumn ?? place.end_column;
  const from = offset(place.line, place.column);
  return [from, Math.max(from + 1, offset(end, last))];
}

function mark() {
  const text = program.value, ranges = problems.filter(p => p.line && p.file === given.file).map(p => [...rangeOf(p), p.severity]);
  if (nowAt && nowAt.line && nowAt.file === given.file) ranges.push([...rangeOf(nowAt), "now"]);
  if (!ranges.length) { at("marks").replaceChildren(); return; }
  const cuts = [...new Set([0, text.length, ...ranges.flatMap(([a, b]) => [a, b])])].filter(x => x <= text.length).sort((a, b) => a - b);
  const shown = document.createDocumentFragment();
  for (let i = 0; i + 1 < cuts.length; i++) {
    const kindsHere = ranges.filter(([a, b]) => a <= cuts[i] && cuts[i] < b).map(r => r[2]), piece = text.slice(cuts[i], cuts[i + 1]);
    shown.append(kindsHere.length ? make("span", {class: kindsHere.join(" ")}, piece.replace(/\n/g, kindsHere.length ? " \n" : "\n")) : piece);
  }
  if (ranges.some(([, b]) => b > text.length)) shown.append(make("span", {class: ranges.find(([, b]) => b > text.length)[2]}, "  "));
  shown.append("\n ");
  at("marks").replaceChildren(shown);
  follow();
}

function follow() {
  for (const layer of [at("colours"), at("marks")]) { layer.scrollTop = program.scrollTop; layer.scrollLeft = program.scrollLeft; }
  at("gutter").scrollTop = program.scrollTop;
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
program.addEventListener("input", () => { edited(); });
