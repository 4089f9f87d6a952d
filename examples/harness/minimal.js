// A whole implementation of a very small part of Scenic, to be judged: programs of one line, `ego = Object at (X, Y)`, whose
// coordinates are numbers or Range(a, b).   scenic-ref conformance --impl 'node minimal.js'
const lines = require("readline").createInterface({ input: process.stdin });
const NUMBER = "-?\\d+(?:\\.\\d+)?", PLACE = `(${NUMBER}|Range\\(${NUMBER}, ${NUMBER}\\))`;
const PROGRAM = new RegExp(`^\\s*ego = Object at \\(${PLACE}, ${PLACE}\\)\\s*$`);

let program = null;                                    // the two coordinates of the program that was compiled

function random(seed) {                                // numbers between 0 and 1 that follow from the seed
  let state = seed >>> 0;
  return () => {
    state = (state + 0x6d2b79f5) >>> 0;
    let t = Math.imul(state ^ (state >>> 15), state | 1);
    t ^= t + Math.imul(t ^ (t >>> 7), t | 61);
    return ((t ^ (t >>> 14)) >>> 0) / 4294967296;
  };
}

function value(text, next) {
  if (!text.startsWith("Range")) return Number(text);
  const [low, high] = text.slice(6, -1).split(", ").map(Number);
  return low + (high - low) * next();
}

const answers = {
  start: () => [{ answer: "started", protocol: "scenic-ref/harness/1", name: "minimal", version: "1", dialects: ["paper"], capabilities: ["scenes"] }],
  compile: (asked) => {
    program = PROGRAM.exec(asked.program);
    return [program ? { answer: "compiled" } : { answer: "skipped", reason: "only `ego = Object at (X, Y)` is implemented" }];
  },
  sample: function* (asked) {
    const next = random(asked.seed);
    for (let number = 0; number < asked.count; number++) {
      const position = [value(program[1], next), value(program[2], next)];
      const ego = { id: 0, name: "ego", class: "Object", position, heading: 0, width: 1, length: 1, properties: {} };
      yield { answer: "scene", scene: { scene: number, params: {}, ego: 0, objects: [ego] } };
    }
    yield { answer: "done" };
  },
  stop: () => [{ answer: "stopped" }],
};

lines.on("line", (line) => {
  const asked = JSON.parse(line);
  for (const answer of answers[asked.request](asked)) process.stdout.write(JSON.stringify({ id: asked.id, ...answer }) + "\n");
  if (asked.request === "stop") process.exit(0);
});
