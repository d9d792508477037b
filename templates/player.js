"use strict";
// The player of a geotween map: <geotween-map> behaves as a media element does.
// The block keeps its names to itself.
{
const SVG = "http://www.w3.org/2000/svg";
const ICONS = {
  play: "M7 4v16l13-8z", pause: "M6 4h4v16H6zM14 4h4v16h-4z",
  replay: "M12 5V1L7 6l5 5V7a6 6 0 1 1-6 6H4a8 8 0 1 0 8-8z",
  previous: "M6 5h2v14H6zM19 5v14l-10-7z", next: "M16 5h2v14h-2zM5 5v14l10-7z",
  loop: "M7 7h10v3l4-4-4-4v3H5v6h2zM17 17H7v-3l-4 4 4 4v-3h12v-6h-2z",
};
const SPEEDS = [0.5, 1, 2, 4];
const LEGIBLE = 8; // px of the screen

const clamp = (x, low, high) => Math.min(Math.max(x, low), high);
const mix = (a, b, t) => a + (b - a) * t;
const thousandth = (x) => Math.round(x * 1000) / 1000;

function summed(differences, stride = 1) {
  const values = Int32Array.from(differences);
  for (let i = stride; i < values.length; i++) values[i] += values[i - stride];
  return values;
}

// From here to decode: the reading of what docs/format.md tells.
function numbers(text) {
  const found = [];
  for (let i = 0, high = 0; i < text.length; i++) {
    const code = text.charCodeAt(i) - 35, digit = code - (code > 25) - (code > 57);
    if (digit > 63) { high = high * 26 + digit - 63; continue; }
    const folded = high * 64 + digit;
    found.push(folded % 2 ? -(folded + 1) / 2 : folded / 2);
    high = 0;
  }
  return Int32Array.from(found);
}

function decodeVertices({ points, starts, ways, jumps, moments, lives }) {
  const codes = numbers(ways), leaps = numbers(jumps), spells = numbers(lives), count = codes.length;
  const from = new Int32Array(count), to = new Int32Array(count);
  const since = new Float64Array(count), until = new Float64Array(count).fill(1);
  let a = 0, b = 0, newStart = 0, newEnd = starts, jump = 0, life = -3, left = 0, start = 0, end = 0;
  const next = (last, code, fresh) => code < 2 ? last + code : code === 2 ? fresh : last + leaps[jump++];
  for (let i = 0; i < count; i++) {
    const code = codes[i] % 5;
    a = next(a, (codes[i] - code) / 5, newStart);
    b = code === 4 ? a : next(b, code, newEnd);
    if (a < starts) newStart = Math.max(newStart, a + 1);
    newEnd = Math.max(newEnd, b + 1);
    from[i] = a;
    to[i] = b;
    if (a === b) continue;
    while (!left) {
      start += spells[life += 3];
      end += spells[life + 1];
      left = spells[life + 2];
    }
    left--;
    since[i] = moments[start];
    until[i] = moments[end];
  }
  return { points: summed(numbers(points), 2), from, to, since, until };
}

function decodeNodes(track, base, unseen) {
  const nodes = [], script = numbers(track.nodes);
  let place = 0, node = unseen;
  for (let i = 0; i < script.length;) {
    if (base) {
      place += script[i++];
      for (let count = script[i++]; count > 0; count--) nodes.push(base[place++]);
    }
    if (i === script.length) break;
    node += script[i++];
    const count = script[i++];
    for (let k = Math.abs(count); k > 0; k--, node += Math.sign(count)) nodes.push(node);
  }
  return Int32Array.from(nodes);
}

function decodeFrames(places) {
  const frames = [];
  for (const differences of places) {
    const frame = summed(numbers(differences), 2), before = frames.at(-1);
    frames.push(before ? frame.map((value, i) => value + before[i]) : frame);
  }
  return frames;
}

function decodeSeams({ rings, seams = [] }) {
  const codes = new Uint8Array(rings.reduce((sum, count) => sum + count, 0));
  for (let i = 0, edge = 0; i < seams.length; edge += seams[i + 1], i += 2) {
    codes.fill(seams[i], edge, edge + seams[i + 1]);
  }
  return codes;
}

function decode(data) {
  const vertices = decodeVertices(data), found = [];
  let unseen = 0;
  for (const track of data.tracks) {
    const { rings, times, base } = track;
    const life = (track.life ?? []).map((i) => data.moments[i]);
    const decoded = { rings, times, life, vertices, codes: decodeSeams(track) };
    if ("nodes" in track) {
      const nodes = decodeNodes(track, found[found.length - base]?.nodes, unseen);
      unseen = nodes.reduce((most, node) => Math.max(most, node + 1), unseen);
      Object.assign(decoded, { nodes }, movingOf(nodes, vertices));
    } else {
      const frames = decodeFrames(track.places), moves = frames.length > 1;
      Object.assign(decoded, { frames, first: moves ? times[0] : 0, last: moves ? times.at(-1) : 0 });
    }
    found.push(decoded);
  }
  return found;
}

// Which vertices move, since when the first, until when the last.
function movingOf(nodes, { from, to, since, until }) {
  const moving = Uint32Array.from(nodes.keys()).filter((i) => from[nodes[i]] !== to[nodes[i]]);
  let first = moving.length ? 1 : 0, last = 0;
  for (const i of moving) {
    first = Math.min(first, since[nodes[i]]);
    last = Math.max(last, until[nodes[i]]);
  }
  return { moving, first, last };
}

// A cubic Bézier curve at u, by bisection.
function ease(points, u) {
  if (!points || u <= 0 || u >= 1) return clamp(u, 0, 1);
  const [x1, y1, x2, y2] = points;
  const at = (a, b, s) => 3 * s * (1 - s) * (a * (1 - s) + b * s) + s ** 3;
  let low = 0, high = 1;
  for (let i = 0; i < 45; i++) {
    const middle = (low + high) / 2;
    if (at(x1, x2, middle) < u) low = middle; else high = middle;
  }
  return clamp(at(y1, y2, high), 0, 1);
}

// Where one track gives way to another, that one is.
function isThere({ life }, t) {
  const [since = 0, until = 1] = life;
  return since <= t && (t < until || t === 1 && until === 1);
}

function placesOf({ nodes, vertices, frames }) {
  if (!nodes) return Float64Array.from(frames[0]);
  const xy = new Float64Array(2 * nodes.length);
  nodes.forEach((node, i) => {
    xy[2 * i] = vertices.points[2 * vertices.from[node]];
    xy[2 * i + 1] = vertices.points[2 * vertices.from[node] + 1];
  });
  return xy;
}

function move(track, xy, t) {
  if (track.nodes) return moveShared(track, xy, t);
  const { times, frames } = track;
  let k = 0;
  while (k < times.length - 2 && times[k + 1] <= t) k++;
  const a = frames[k], b = frames[k + 1], length = times[k + 1] - times[k];
  const s = length > 0 ? clamp((t - times[k]) / length, 0, 1) : 1;
  for (let i = 0; i < xy.length; i++) xy[i] = mix(a[i], b[i], s);
}

function moveShared({ nodes, moving, vertices: { points, from, to, since, until } }, xy, t) {
  for (let k = 0; k < moving.length; k++) {
    const i = moving[k], node = nodes[i], a = 2 * from[node], b = 2 * to[node];
    const s = clamp((t - since[node]) / (until[node] - since[node]), 0, 1);
    xy[2 * i] = mix(points[a], points[b], s);
    xy[2 * i + 1] = mix(points[a + 1], points[b + 1], s);
  }
}

// What a shape draws, by vertex numbers: whole rings (wanted is null), or runs of edges of one code.
function linesOf({ rings, codes }, wanted) {
  const lines = [];
  let first = 0;
  for (const count of rings) {
    const drawn = (k) => wanted === null || codes[first + k % count] === wanted;
    let gap = 0;
    while (gap < count && drawn(gap)) gap++;
    if (gap === count && count) {
      lines.push({ closed: true, vertices: Array.from({ length: count }, (_, k) => first + k) });
    }
    // Begins behind an edge that is not drawn: the ring's end cuts no run in two.
    for (let k = gap + 1, run = null; k < gap + count && gap < count; k++) {
      if (!drawn(k)) { run = null; continue; }
      if (!run) lines.push({ closed: false, vertices: run = [first + k % count] });
      run.push(first + (k + 1) % count);
    }
    first += count;
  }
  return lines.map(({ closed, vertices }) => ({ closed, vertices: Uint32Array.from(vertices) }));
}

function mixColour(a, b, t) {
  if (a === b || a === "none" || b === "none") return t < 0.5 ? a : b;
  const channel = (text, i) => parseInt(text.slice(i, i + 2), 16);
  return "#" + [1, 3, 5].map((i) =>
    Math.round(mix(channel(a, i), channel(b, i), t)).toString(16).padStart(2, "0")).join("");
}

// The stroke of a seam fades in and out over a twentieth.
function seamOpacity(code, u) {
  const opening = code & 1 ? 20 * u : 1;
  const closing = code & 2 ? 20 * (1 - u) : 1;
  return thousandth(clamp(Math.min(opening, closing), 0, 1));
}

// A rest wins over both transitions that meet there, even if it lasts no time.
function spanAt(spans, time) {
  const rest = spans.findIndex(({ step, start, end }) => step !== null && start <= time && time <= end);
  return rest < 0 ? spans.findIndex(({ end }) => time < end) : rest;
}

function stepAt(steps, time) {
  return Math.max(0, steps.findLastIndex((step, i) =>
    i === 0 || time >= (steps[i - 1].end + step.start) / 2));
}

// The line through points at x; of several with one x the first counts.
function along(xs, ys, x) {
  const k = xs.findIndex((value) => value >= x);
  if (k < 0) return ys.at(-1);
  return k === 0 || xs[k] === x ? ys[k] : mix(ys[k - 1], ys[k], (x - xs[k - 1]) / (xs[k] - xs[k - 1]));
}

// Starts and ends of rests, and their places on the axis: by the steps' times, if these rise.
function axisOf(steps, duration) {
  const moments = steps.map(({ time }) => (typeof time === "string" ? Date.parse(time) : time ?? NaN));
  const first = moments[0], length = moments.at(-1) - first;
  const real = length > 0 && moments.every((moment, i) => i === 0 || moment > moments[i - 1]);
  const times = steps.flatMap(({ start, end }) => [start, end]);
  const places = times.map((time, i) => (real ? duration * (moments[i >> 1] - first) / length : time));
  return { times, places };
}

// Labels that have room: first, last, the current one moved between them, and what keeps clear.
function roomFor(boxes, current) {
  const first = boxes[0], last = boxes.at(-1), shown = new Map([[0, first], [boxes.length - 1, last]]);
  if (!shown.has(current)) {
    const { left, width } = boxes[current];
    shown.set(current, { left: Math.max(first.width + first.left, Math.min(left, last.left - width)), width });
  }
  const clear = (a, b) => a.left + a.width <= b.left || b.left + b.width <= a.left;
  boxes.forEach((box, i) => {
    if (!shown.has(i) && [...shown.values()].every((other) => clear(box, other))) shown.set(i, box);
  });
  return shown;
}

function make(name, attributes = {}, ...children) {
  const svg = ["g", "path", "svg", "text"].includes(name);
  const element = svg ? document.createElementNS(SVG, name) : document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (typeof value === "function") element.addEventListener(key, value);
    else element.setAttribute(key, value);
  }
  element.append(...children);
  return element;
}

// Writing costs paint even when nothing changed. null removes.
function put(element, name, value) {
  if (value === null) element.removeAttribute(name);
  else if (element.getAttribute(name) !== String(value)) element.setAttribute(name, value);
}

function finite(value) {
  if (Number.isFinite(+value)) return +value;
  throw new TypeError(`not a finite number: ${value}`);
}

// Writes a path as bytes, so that it makes a single string. Places are rounded, not differences:
// what touches goes on touching.
class Pen {
  #bytes = new Uint8Array(1 << 16);
  #length = 0;
  #decoder = new TextDecoder();

  constructor(grid) { this.scale = 100 * grid; }

  line({ vertices, closed }, xy) {
    this.#makeRoom(26 * vertices.length);
    for (let k = 0; k < vertices.length; k++) {
      const i = 2 * vertices[k];
      this.#bytes[this.#length++] = k === 0 ? 77 : k === 1 ? 76 : 32; // M, L, space
      this.#number(Math.round(xy[i] * this.scale));
      this.#bytes[this.#length++] = 32;
      this.#number(Math.round(xy[i + 1] * this.scale));
    }
    if (closed) this.#bytes[this.#length++] = 90; // Z
  }

  take() {
    const text = this.#decoder.decode(this.#bytes.subarray(0, this.#length));
    this.#length = 0;
    return text;
  }

  #number(hundredths) {
    const bytes = this.#bytes;
    let n = this.#length, rest = hundredths;
    if (rest < 0) { bytes[n++] = 45; rest = -rest; } // -
    let unit = 100;
    while (10 * unit <= rest) unit *= 10;
    for (; unit >= 100 || rest > 0; unit /= 10) {
      if (unit === 10) bytes[n++] = 46; // .
      const digit = rest / unit | 0;
      bytes[n++] = 48 + digit;
      rest -= digit * unit;
    }
    this.#length = n;
  }

  #makeRoom(more) {
    if (this.#length + more + 1 <= this.#bytes.length) return;
    const bytes = new Uint8Array(2 * (this.#length + more));
    bytes.set(this.#bytes);
    this.#bytes = bytes;
  }
}

class Picture {
  #frame = 0;
  #pen;

  constructor(figure, data) {
    const stage = figure.querySelector("g.stage");
    this.#pen = new Pen(data.grid);
    Object.assign(this, { figure, data });
    this.groups = data.groups.map(({ layer }) => make("g", { class: "layer", "data-layer": layer }));
    this.slots = data.slots.map((slot) => this.#slot(slot));
    this.spans = this.#spans();
    this.words = [...figure.querySelectorAll(".annotation text, .scale-bar text")].map((element) => ({
      element, size: Number(element.getAttribute("font-size")) }));
    this.annotations = [...figure.querySelectorAll("g.annotation")].map((element) => ({
      element, steps: element.dataset.steps.split(" ").map(Number) }));
    const labels = figure.querySelector("g.labels");
    labels?.replaceChildren();
    this.labels = data.labels.map(({ text, key, size, room, spans }) => {
      const element = make("text", {
        class: "label", "data-key": key, "font-weight": 600,
        "text-anchor": "middle", "dominant-baseline": "middle" }, text);
      labels.append(element);
      const way = (places) => [0, 1, 2].map((k) => places.map((place) => place[k]));
      return { element, size, room, ways: data.spans.map((_, i) => spans[i] && way(spans[i])) };
    });
    stage.replaceChildren(...this.groups);
  }

  // On a small map labels grow to be read, or give way.
  fit() {
    const scale = this.figure.getScreenCTM()?.a || 1;
    for (const { element, size, room } of this.labels) {
      const drawn = size * clamp(1 / scale, 1, room);
      put(element, "font-size", drawn);
      put(element, "display", drawn * scale < LEGIBLE ? "none" : null);
    }
    for (const { element, size } of this.words) put(element, "font-size", Math.max(size, LEGIBLE / scale));
  }

  draw(time, step) {
    const { spans, easing } = this.data;
    const place = spanAt(spans, time), span = spans[place];
    const length = span.step === null ? span.end - span.start : 0;
    const u = length > 0 ? (time - span.start) / length : 0;
    const t = ease(easing, u);
    for (let i = 0; i < this.groups.length; i++) {
      const [a, b] = this.data.groups[i].opacity;
      put(this.groups[i], "opacity", thousandth(mix(a, b, t)));
    }
    this.#frame++;
    for (const shape of this.spans[place]) {
      if (!shape.show || u >= shape.show[0] && u <= shape.show[1]) this.#drawShape(shape, u, t);
    }
    for (const slot of this.slots) put(slot.element, "visibility", slot.frame === this.#frame ? null : "hidden");
    for (const { element, ways } of this.labels) this.#place(element, ways[place], t);
    for (const { element, steps } of this.annotations) {
      put(element, "visibility", steps.includes(step) ? null : "hidden");
    }
  }

  #drawShape(shape, u, t) {
    const { slot, from, to } = shape;
    slot.frame = this.#frame;
    this.#drawPath(shape, t);
    put(slot.element, "fill", mixColour(from.fill, to.fill, t));
    put(slot.element, "stroke", mixColour(from.stroke, to.stroke, t));
    put(slot.element, "stroke-width", thousandth(mix(from.width, to.width, t)));
    put(slot.element, "stroke-dasharray", (t < 0.5 ? from.dash : to.dash) || null);
    if (slot.kind === "seam") put(slot.element, "stroke-opacity", seamOpacity(shape.code, u));
  }

  // Writes a path only if something of it has moved, come or gone.
  #drawPath(shape, t) {
    const { slot, parts } = shape;
    let changed = slot.shape !== shape;
    slot.shape = shape;
    for (const part of parts) {
      const moment = isThere(part.track, t) ? clamp(t, part.track.first, part.track.last) : null;
      if (moment === part.moment) continue;
      part.moment = moment;
      if (moment !== null && part.track.last > 0) move(part.track, part.xy, moment);
      changed = true;
    }
    if (!changed) return;
    for (const { lines, xy, moment } of parts) {
      if (moment !== null) for (const line of lines) this.#pen.line(line, xy);
    }
    put(slot.element, "d", this.#pen.take());
  }

  #place(element, way, t) {
    put(element, "visibility", way ? null : "hidden");
    if (!way) return;
    const [times, xs, ys] = way;
    put(element, "x", thousandth(along(times, xs, t)));
    put(element, "y", thousandth(along(times, ys, t)));
  }

  #slot({ group, kind, key }) {
    const region = kind === "region";
    const element = make("path", {
      class: kind, "stroke-linejoin": "round",
      ...(region && { "data-layer": this.data.groups[group].layer }),
      ...((region || key) && { "data-key": key }),
    });
    this.groups[group].append(element);
    return { element, kind, shape: null, frame: 0 };
  }

  #spans() {
    const { spans, paints } = this.data;
    const tracks = decode(this.data), known = tracks.map(() => new Map());
    const part = (index, wanted) => {
      const track = tracks[index], lines = known[index];
      if (!lines.has(wanted)) lines.set(wanted, linesOf(track, wanted));
      return { track, lines: lines.get(wanted), xy: placesOf(track), moment: null };
    };
    return spans.map(({ shapes }) => shapes.map(({ slot: number, tracks: indices, paint, code, show }) => {
      const slot = this.slots[number];
      const wanted = { border: 0, seam: code }[slot.kind] ?? null;
      const parts = Array.from(summed(indices), (index) => part(index, wanted));
      return { slot, code, show, parts, from: paints[paint[0]], to: paints[paint[1]] };
    }));
  }
}

// Time passes while it plays and someone can see it.
class Clock {
  duration = 0;
  loop = false;
  paused = true;
  rate = 1;
  #exact = 0;
  #awake = false;
  #stamp = null;
  #request = 0;

  constructor(onTick) { this.onTick = onTick; }

  get time() { return thousandth(this.#exact); }
  set time(value) { this.#exact = clamp(value, 0, this.duration); }

  set awake(value) {
    this.#awake = value;
    this.run();
  }

  run() {
    const runs = this.#awake && !this.paused;
    if (runs === Boolean(this.#request)) return;
    if (!runs) cancelAnimationFrame(this.#request);
    this.#request = runs ? requestAnimationFrame(this.#tick) : 0;
    this.#stamp = null;
  }

  #tick = (now) => {
    this.#request = requestAnimationFrame(this.#tick);
    // Without frames for long it was not seen.
    const passed = Math.min(now - (this.#stamp ?? now), 1000) / 1000;
    this.#stamp = now;
    const time = this.#exact + passed * this.rate, over = time >= this.duration;
    const again = over && this.loop && this.duration > 0;
    this.time = again ? time % this.duration : time;
    this.onTick(now, over && !again);
  };
}

// Who moves in time takes over: the clock stops.
class Controls {
  constructor(map, figure, { steps, duration, words }) {
    const axis = axisOf(steps, duration);
    Object.assign(this, { map, steps, words, axis, boxes: [] });
    this.previous = this.#button("previous", () => this.#goTo(this.#before()));
    this.play = this.#button("play", () => this.#toggle());
    this.next = this.#button("next", () => this.#goTo(this.#after()));
    this.loop = this.#button("loop", () => { map.loop = !map.loop; });
    const rates = SPEEDS.map((rate) => make("option", { value: rate }, `${rate}×`.replace(".", words.decimal ?? ".")));
    this.speed = make("select", {
      class: "speed", "aria-label": words.speed, change: () => { map.playbackRate = this.speed.value; } }, ...rates);
    this.range = make("input", {
      type: "range", class: "time", max: duration, step: "any", "aria-label": words.time,
      input: () => this.#moveTo(along(axis.places, axis.times, this.range.valueAsNumber)) });
    // Arrow keys reach every step: no tab stops.
    this.labels = steps.map(({ label }, i) =>
      make("button", { type: "button", class: "mark", tabindex: -1, click: () => this.#goTo(i) }, label));
    const ticks = steps.map(() => make("span", { class: "tick" }));
    ticks.forEach((tick, i) => { tick.style.left = `${100 * this.#share(i)}%`; });
    this.marks = make("div", { class: "marks" }, ...ticks, ...this.labels);
    this.caption = make("p", { class: "caption" });
    // Every caption takes its room, so that the page does not jump.
    const sizers = steps.map((step) => make("p", { class: "sizer", "aria-hidden": "true" }, ...this.#text(step)));
    this.element = make("div", { class: "controls" }, make("div", { class: "captions" }, this.caption, ...sizers));
    if (steps.length > 1) {
      this.element.prepend(make("div", { class: "transport" },
        make("div", { class: "buttons" }, this.previous, this.play, this.next, this.loop, this.speed),
        make("div", { class: "timeline" }, this.range, this.marks)));
    }
    figure.after(this.element);
  }

  #button(name, click) {
    const icon = make("svg", { viewBox: "0 0 24 24", "aria-hidden": "true" }, make("path", { d: ICONS[name] }));
    return make("button", { type: "button", class: name, "aria-label": this.words[name], click }, icon);
  }

  #text({ label, caption, alt }) {
    return [make("strong", {}, label), " ", caption, make("span", { class: "unseen" }, ` ${alt}`)];
  }

  showTime(time) {
    const { previous, next, range, axis, map } = this;
    range.value = along(axis.times, axis.places, time);
    range.style.setProperty("--done", `${100 * range.value / (map.duration || 1)}%`);
    // Not `disabled`, which would drop the focus.
    put(previous, "aria-disabled", this.#before() < 0 ? "true" : null);
    put(next, "aria-disabled", this.#after() < 0 ? "true" : null);
    this.showState();
  }

  showState() {
    const { play, loop, speed, caption, map, words } = this;
    const name = !map.paused ? "pause" : map.ended ? "replay" : "play";
    put(play, "aria-label", words[name]);
    put(play.querySelector("path"), "d", ICONS[name]);
    put(loop, "aria-pressed", String(map.loop));
    speed.value = map.playbackRate;
    // What plays by itself is not read aloud.
    put(caption, "aria-live", map.paused ? "polite" : "off");
  }

  showStep(current) {
    const { caption, labels, range, words } = this;
    const step = this.steps[current];
    const values = { ...step, n: current + 1, count: labels.length };
    caption.replaceChildren(...this.#text(step));
    range.setAttribute("aria-valuetext", words.place.replace(/\{(\w+)\}/g, (_, name) => values[name]));
    labels.forEach((label, i) => put(label, "aria-current", i === current ? "step" : null));
    this.#placeMarks();
  }

  #share(i) { return this.axis.places[2 * i] / (this.map.duration || 1); }

  fit() {
    const room = this.marks.clientWidth;
    this.boxes = this.labels.map((label, i) => {
      const width = label.offsetWidth;
      const left = clamp(room * this.#share(i) - width / 2, -10, Math.max(0, room - width + 10));
      return { left, width };
    });
    this.#placeMarks();
  }

  #placeMarks() {
    if (!this.boxes.length) return;
    const shown = roomFor(this.boxes, this.map.currentStep);
    this.labels.forEach((label, i) => {
      label.style.visibility = shown.has(i) ? "" : "hidden";
      label.style.left = `${(shown.get(i) ?? this.boxes[i]).left}px`;
    });
  }

  #before() { return this.steps.findLastIndex((step) => step.end < this.map.currentTime); }
  #after() { return this.steps.findIndex((step) => step.start > this.map.currentTime); }
  #toggle() { if (this.map.paused) this.map.play(); else this.map.pause(); }
  #goTo(step) { this.#moveTo(this.steps[step]?.start ?? this.map.currentTime); }
  #moveTo(time) {
    this.map.pause();
    this.map.currentTime = time;
  }

  actionOf({ key, repeat, target }) {
    if (this.steps.length < 2 || target === this.speed || key === " " && target.closest("button")) return null;
    const toggle = () => repeat || this.#toggle();
    const back = () => this.#goTo(this.#before());
    const on = () => this.#goTo(this.#after());
    return {
      " ": toggle, k: toggle, K: toggle,
      ArrowLeft: back, ArrowRight: on, PageUp: back, PageDown: on,
      Home: () => this.#goTo(0), End: () => this.#goTo(this.steps.length - 1),
      // Elsewhere these two scroll the page.
      ...(target === this.range && { ArrowDown: back, ArrowUp: on }),
    }[key];
  }
}

// What is told of a region: under the mouse, at a tap, by keys.
class Tips {
  #step = 0;
  #key = null;

  constructor(map, figure, { tips, words }) {
    // Empty it is unseen, yet a live region.
    const element = make("div", { class: "tip" });
    Object.assign(this, { map, figure, element, tips: tips.map((of) => new Map(Object.entries(of))) });
    map.append(element);
    put(figure, "role", "application");
    put(figure, "tabindex", 0);
    put(figure, "aria-description", words.regions);
    const point = ({ type, pointerType, target, clientX, clientY }) => {
      if (type !== "click" && pointerType === "touch") return;
      this.#show(target.closest("path.region")?.dataset.key, "off");
      this.#place(clientX, clientY);
    };
    for (const type of ["pointermove", "pointerleave", "click"]) figure.addEventListener(type, point);
    figure.addEventListener("blur", () => this.#show());
  }

  showStep(step) {
    this.#step = step;
    this.#show(this.#regions().some(({ dataset }) => dataset.key === this.#key) ? this.#key : undefined);
  }

  actionOf({ key, shiftKey, target }) {
    if (key === "Escape" && this.#key !== null) return () => this.#show();
    return target === this.figure && /^n$/i.test(key) ? () => this.#walk(shiftKey ? -1 : 1) : null;
  }

  #walk(way) {
    const keys = [...new Set(this.#regions().map(({ dataset }) => dataset.key))].filter((key) => this.#tip(key));
    const place = keys.indexOf(this.#key) + way;
    this.#show(keys.at(place < 0 ? -1 : place % keys.length), "polite");
    const box = this.figure.querySelector(".here")?.getBoundingClientRect();
    if (box) this.#place(box.x + box.width / 2, box.y + box.height / 2);
  }

  #regions() { return [...this.figure.querySelectorAll("g.stage path.region:not([visibility])")]; }

  // What the nearest step says of a key.
  #tip(key) {
    const { tips } = this, step = this.#step;
    for (let away = 0; away < tips.length; away++) {
      const found = tips[step - away]?.get(key) ?? tips[step + away]?.get(key);
      if (found) return found;
    }
  }

  #show(key, live) {
    const tip = this.#tip(key);
    this.#key = tip ? key : null;
    if (live) this.element.setAttribute("aria-live", live);
    const rows = tip?.rows.flatMap(([label, value]) => [make("dt", {}, label), make("dd", {}, value)]);
    this.element.replaceChildren(...(tip ? [make("strong", {}, tip.name)] : []),
      ...(rows?.length ? [make("dl", {}, ...rows)] : []));
    for (const region of this.figure.querySelectorAll("path.region")) {
      const here = tip !== undefined && region.dataset.key === key;
      region.classList.toggle("here", here);
      put(region, "vector-effect", here ? "non-scaling-stroke" : null);
    }
  }

  // Above a point of the window, or below it.
  #place(x, y) {
    const { element } = this, box = this.map.getBoundingClientRect();
    const { offsetWidth: width, offsetHeight: height } = element;
    element.style.left = `${clamp(x - box.x - width / 2, 0, Math.max(0, box.width - width))}px`;
    element.style.top = `${(y > height + 16 ? y - height - 12 : y + 20) - box.y}px`;
  }
}

class GeotweenMap extends HTMLElement {
  static parts = { decode, Picture };

  #steps = [];
  #clock = new Clock((now, over) => this.#tick(now, over));
  #picture = null;
  #controls = null;
  #tips = null;
  #step = null;
  #connection = null;
  #still = matchMedia("(prefers-reduced-motion: reduce)");
  #seen = false;
  #told = -Infinity;

  get currentTime() { return this.#clock.time; }
  set currentTime(value) {
    this.#clock.time = thousandth(finite(value));
    this.#show();
    this.#tell("timeupdate");
  }
  get duration() { return this.#clock.duration; }
  get paused() { return this.#clock.paused; }
  get ended() { return !this.loop && this.#steps.length > 0 && this.currentTime >= this.duration; }
  get steps() { return this.#steps.map(({ label, start, end }) => ({ label, start, end })); }
  get currentStep() { return this.#step ?? 0; }
  get playbackRate() { return this.#clock.rate; }
  set playbackRate(value) {
    this.#set("rate", finite(value));
    this.#tell("ratechange");
  }
  get loop() { return this.#clock.loop; }
  set loop(value) { this.#set("loop", Boolean(value)); }

  async play() {
    if (!this.paused) return;
    if (this.ended) this.currentTime = 0;
    this.#set("paused", false);
    this.#tell("play");
  }

  pause() {
    if (this.paused) return;
    this.#set("paused", true);
    this.#tell("pause");
  }

  connectedCallback() {
    this.#connection = new AbortController();
    const { signal } = this.#connection;
    const fresh = !this.#picture;
    if (fresh && !this.#build()) {
      // A script above the element sees it before its content has been read.
      const again = () => this.isConnected && this.connectedCallback();
      if (document.readyState === "loading") {
        document.addEventListener("DOMContentLoaded", again, { once: true, signal });
      }
      return;
    }
    const wake = () => { this.#clock.awake = this.#seen && !document.hidden; };
    const sight = new IntersectionObserver((entries) => {
      this.#seen = entries.at(-1).isIntersecting;
      wake();
    });
    sight.observe(this.querySelector("svg"));
    const size = new ResizeObserver(() => { this.#picture.fit(); this.#controls.fit(); });
    size.observe(this);
    document.addEventListener("visibilitychange", wake, { signal });
    this.#still.addEventListener("change", () => this.#show(), { signal });
    signal.addEventListener("abort", () => {
      sight.disconnect();
      size.disconnect();
      this.#clock.awake = false;
    });
    if (fresh && !this.#still.matches && this.#steps.length > 1) this.play();
  }

  disconnectedCallback() { this.#connection.abort(); }

  #build() {
    const json = this.querySelector("script[type='application/json']");
    const figure = this.querySelector("svg");
    if (!json || !figure?.querySelector("g.stage")) return false;
    const data = JSON.parse(json.textContent);
    if (data.version !== 3) throw new RangeError("geotween-map reads keyframes of version 3");
    // A clone of a playing element brings controls that nobody listens to.
    for (const old of this.querySelectorAll(":scope > .controls, :scope > .tip")) old.remove();
    this.#steps = data.steps;
    Object.assign(this.#clock, { duration: data.duration, loop: data.loop });
    this.#picture = new Picture(figure, data);
    this.#controls = new Controls(this, figure, data);
    if (data.tips.some((of) => Object.keys(of).length)) this.#tips = new Tips(this, figure, data);
    this.addEventListener("keydown", (event) => this.#press(event));
    if (!this.hasAttribute("role")) this.setAttribute("role", "group");
    this.#show();
    return true;
  }

  #set(name, value) {
    this.#clock[name] = value;
    this.#clock.run();
    this.#controls?.showState();
  }

  #press(event) {
    if (event.defaultPrevented || event.ctrlKey || event.altKey || event.metaKey) return;
    const action = this.#tips?.actionOf(event) ?? this.#controls.actionOf(event);
    if (!action) return;
    event.preventDefault();
    action();
  }

  #tick(now, over) {
    this.#show();
    if (!over && now - this.#told < 100) return;
    this.#told = now;
    this.#tell("timeupdate");
    if (!over) return;
    this.pause();
    this.#tell("ended");
  }

  #show() {
    if (!this.#picture) return;
    const before = this.#step, step = stepAt(this.#steps, this.currentTime);
    // Where motion is not welcome one step follows another at once.
    const time = this.#still.matches ? this.#steps[step].start : this.currentTime;
    this.#picture.draw(time, step);
    if (step !== before) {
      this.#step = step;
      this.#controls.showStep(step);
      this.#tips?.showStep(step);
      if (before !== null) this.#tell("stepchange", { step });
    }
    this.#controls.showTime(time);
  }

  #tell(type, detail = null) { this.dispatchEvent(new CustomEvent(type, { detail })); }
}

if (!customElements.get("geotween-map")) customElements.define("geotween-map", GeotweenMap);
}
