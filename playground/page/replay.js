// A simulation that is played again.

let played = null, moment = 0, playing = null, simulating = "";

function simulation() {
  const timestep = Number(at("timestep").value);
  return {simulator: at("simulator").value, steps: Math.max(0, Math.floor(Number(at("steps").value))), timestep: timestep > 0 ? timestep : null};
}

function replayIfNeeded() {
  const index = Math.max(0, Math.floor(Number(at("run").value))), key = JSON.stringify([state.version, simulation(), index]);
  if (key === simulating) return;
  simulating = key;
  stopPlaying();
  played = null;
  at("stage").hidden = true;
  at("replay-tally").replaceChildren();
  say("replay-message", "");
  ask("replay", "simulate", {...simulation(), start: index, count: 1}, found => {
    if (found.kind === "run") { showRun(found); if (!state.dynamic) at("replay-message").append(" Nothing in this program acts: it has no behavior, and says nothing about time."); }
    else if (found.kind === "simulated" && found.attempts) at("replay-tally").replaceChildren(tallyShown(found, "simulation"));
    else if (messageOf(found)) say("replay-message", messageOf(found), true);
  });
}

function pose(k, now) {
  const created = played.run.objects[k] || {width: 1, length: 1, position: [0, 0], heading: 0, class: "?", id: k};
  return {...created, ...now.objects[k], id: k, name: created.name, class: created.class};
}

const place = share => `calc(${100 * share}% - ${3 * share}px)`;

function showRun(found) {
  played = found;
  moment = 0;
  const steps = found.run.steps;
  let west = Infinity, south = Infinity, east = -Infinity, north = -Infinity;
  for (const now of steps) now.objects.forEach((_, k) => {
    const {position: [x, y], width, length} = pose(k, now), r = Math.hypot(width, length) / 2;
    west = Math.min(west, x - r); east = Math.max(east, x + r); south = Math.min(south, y - r); north = Math.max(north, y + r);
  });
  const pad = 2 + .06 * Math.max(east - west, north - south), wide = east - west + 2 * pad, tall = north - south + 2 * pad;
  const ratio = Math.min(2.2, Math.max(1.15, wide / tall)), width = 560, height = Math.round(width / ratio);
  played.frame = frame([west - pad, south - pad, east + pad, north + pad], width, height);
  played.moving = svg("g");
  at("view").replaceChildren(svg("svg", {class: "scene", viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": "The simulation, seen from above"}, groundOf(found.ground, played.frame), played.moving, scaleBar(played.frame)));
  at("time").max = steps.length - 1;
  at("strip").replaceChildren(make("b"), ...steps.filter(s => s.events.length).slice(0, 500).map(s => {
    const event = make("i", {title: `step ${s.step}: ${s.events.join("; ")}`, onclick: () => showMoment(s.step)});
    event.style.left = place(s.step / Math.max(steps.length - 1, 1));
    return event;
  }));
  say("replay-message", `${found.run.result}: ${found.run.reason}, after ${plural(steps.length - 1, "time step")} (${number((steps.length - 1) * found.run.timestep)} s); ${plural(found.attempts, "attempt")}`);
  at("stage").hidden = false;
  showMoment(0);
}

function showMoment(k) {
  if (!played) return;
  const steps = played.run.steps, f = played.frame, ego = played.run.ego;
  moment = Math.min(Math.max(k, 0), steps.length - 1);
  const now = steps[moment], objects = now.objects.map((_, i) => pose(i, now));
  const trails = objects.map((o, i) => svg("path", {class: `thing trail ${colourOf(o, ego)}`, d: pathOf(steps.slice(0, moment + 1).filter(s => s.objects[i]).map(s => pose(i, s).position), f, false)}));
  played.moving.replaceChildren(...trails, ...objects.map(o => thing(o, ego, f)), labels(objects, ego, f));
  at("time").value = moment;
  at("clock").textContent = `step ${moment} of ${steps.length - 1}, ${(moment * played.run.timestep).toFixed(2)} s`;
  at("strip").querySelector("b").style.left = place(moment / Math.max(steps.length - 1, 1));
  const side = objects.slice(0, 40).flatMap((o, i) => {
    const taken = (now.actions[i] || []).map(a => a && a.action ? `${a.action}(${a.args.map(told).join(", ")})` : told(a)).join(", ");
    return [make("h3", {}, `${nameOf(o, ego)} (object ${i})`), make("p", {}, [now.doing[i], taken && `takes ${taken}`, typeof o.speed === "number" ? `${o.speed.toFixed(2)} m/s` : ""].filter(Boolean).join(" · "))];
  });
  if (now.events.length) side.push(make("h3", {}, "Events"), make("p", {}, now.events.join("; ")));
  for (const [name, values] of Object.entries(played.records || {})) {
    const last = (values || []).filter(v => Array.isArray(v) && v[0] <= moment).pop();
    if (last) side.push(make("h3", {}, `record ${name}`), make("p", {}, told(last[1])));
  }
  at("side").replaceChildren(...side);
}

function stopPlaying() { clearInterval(playing); playing = null; at("play").textContent = "Play"; }

function startPlaying() {
  if (playing) { stopPlaying(); return; }
  if (!played) return;
  if (moment >= played.run.steps.length - 1) showMoment(0);
  at("play").textContent = "Pause";
  playing = setInterval(() => { if (moment >= played.run.steps.length - 1) stopPlaying(); else showMoment(moment + 1); }, Math.max(16, 1000 * Math.max(played.run.timestep, .02) / Number(at("speed").value)));
}

at("play").onclick = startPlaying;
at("time").oninput = event => { stopPlaying(); showMoment(Number(event.target.value)); };
at("speed").onchange = () => { if (playing) { stopPlaying(); startPlaying(); } };
at("simulator").append(...given.simulators.map(name => new Option(name, name)));
at("simulator").value = given.simulators.includes("kinematic") ? "kinematic" : "still";
at("simulator").onchange = () => { at("timestep").value = at("simulator").value === "still" ? "1" : "0.1"; replayIfNeeded(); };
at("steps").onchange = at("timestep").onchange = at("run").onchange = replayIfNeeded;
