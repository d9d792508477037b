"use strict";
// The player of a geotween map: <geotween-map> behaves as a media element does.
// The block keeps these names out of the page, so that two copies of this script get along;
// the pure functions can be reached as customElements.get("geotween-map").parts.
{
const SVG = "http://www.w3.org/2000/svg";
const WORDS = {
  play: "Play", pause: "Pause", previous: "Previous step", next: "Next step", time: "Time",
  place: (step, label, count) => `${label}, step ${step + 1} of ${count}`,
};
const ICONS = {
  play: "M7 4v16l13-8z", pause: "M6 4h4v16H6zM14 4h4v16h-4z",
  previous: "M6 5h2v14H6zM19 5v14l-10-7z", next: "M16 5h2v14h-2zM5 5v14l10-7z",
};

// ---- pure: numbers in, numbers or text out ----

const clamp = (x, low, high) => Math.min(Math.max(x, low), high);
const mix = (a, b, t) => a + (b - a) * t;
const thousandth = (x) => Math.round(x * 1000) / 1000;

// A file holds differences, because small numbers are short.
function summed(differences, stride = 1) {
  const values = Int32Array.from(differences);
  for (let i = stride; i < values.length; i++) values[i] += values[i - stride];
  return values;
}

// Vertices that tracks share: all points, and from which one to which each vertex goes, and when.
function decodeVertices({ points, ways, jumps, moments, lives }) {
  const count = ways.length;
  const from = new Int32Array(count), to = new Int32Array(count);
  const since = new Float64Array(count), until = new Float64Array(count).fill(1);
  let a = 0, b = 0, jump = 0, life = -3, left = 0, start = 0, end = 0;
  for (let i = 0; i < count; i++) {
    const way = +ways[i];
    a += way ? way >> 1 : jumps[jump++];
    b += way ? way & 1 : jumps[jump++];
    from[i] = a;
    to[i] = b;
    if (a === b) continue;
    while (!left) {
      start += lives[life += 3];
      end += lives[life + 1];
      left = lives[life + 2];
    }
    left--;
    since[i] = moments[start];
    until[i] = moments[end];
  }
  return { points: summed(points, 2), from, to, since, until };
}

// A track's rings as numbers of vertices: by turns what to copy from a track before it, and runs.
function decodeNodes(track, base, unseen) {
  const nodes = [];
  let place = 0, node = unseen;
  for (let i = 0; i < track.nodes.length;) {
    if (base) {
      place += track.nodes[i++];
      for (let count = track.nodes[i++]; count > 0; count--) nodes.push(base[place++]);
    }
    if (i === track.nodes.length) break;
    node += track.nodes[i++];
    const count = track.nodes[i++];
    for (let k = Math.abs(count); k > 0; k--, node += Math.sign(count)) nodes.push(node);
  }
  return Int32Array.from(nodes);
}

// Where a track's own vertices are at each of its key times: displacements undone once.
function decodeFrames(places) {
  const frames = [];
  for (const differences of places) {
    const frame = summed(differences, 2), before = frames.at(-1);
    frames.push(before ? frame.map((value, i) => value + before[i]) : frame);
  }
  return frames;
}

// The seams of a track's edges, one code for each.
function decodeSeams({ rings, seams = [] }) {
  const codes = new Uint8Array(rings.reduce((sum, count) => sum + count, 0));
  for (let i = 0, edge = 0; i < seams.length; edge += seams[i + 1], i += 2) {
    codes.fill(seams[i], edge, edge + seams[i + 1]);
  }
  return codes;
}

// All tracks. Those that share vertices say how much they differ from one before them.
function decode(data) {
  const vertices = decodeVertices(data), found = [];
  let unseen = 0;
  for (const track of data.tracks) {
    const { rings, times, base } = track;
    const life = (track.life ?? []).map((i) => data.moments[i]);
    const decoded = { rings, times, life, vertices, codes: decodeSeams(track) };
    if (track.nodes) {
      const nodes = decodeNodes(track, found[found.length - base]?.nodes, unseen);
      unseen = nodes.reduce((most, node) => Math.max(most, node + 1), unseen);
      decoded.still = nodes.every((node) => vertices.from[node] === vertices.to[node]);
      decoded.nodes = nodes;
    } else {
      decoded.frames = decodeFrames(track.places);
    }
    found.push(decoded);
  }
  return found;
}

// t of a cubic Bézier curve at u. Bisection: there is one call per frame, and it cannot fail.
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

// Where one track gives way to another, that one is drawn.
function isThere({ life: [since = 0, until = 1] }, t) {
  return since <= t && (t < until || t === 1 && until === 1);
}

function verticesAt({ nodes, vertices, times, frames }, t) {
  if (nodes) return sharedAt(vertices, nodes, t);
  let k = 0;
  while (k < times.length - 2 && times[k + 1] <= t) k++;
  const [a, b] = [frames[k], frames[k + 1]];
  const length = times[k + 1] - times[k];
  const s = length > 0 ? clamp((t - times[k]) / length, 0, 1) : 1;
  const xy = new Float64Array(a.length);
  for (let i = 0; i < xy.length; i++) xy[i] = mix(a[i], b[i], s);
  return xy;
}

function sharedAt({ points, from, to, since, until }, nodes, t) {
  const xy = new Float64Array(2 * nodes.length);
  nodes.forEach((node, i) => {
    const a = 2 * from[node], b = 2 * to[node];
    const s = a === b ? 0 : clamp((t - since[node]) / (until[node] - since[node]), 0, 1);
    xy[2 * i] = mix(points[a], points[b], s);
    xy[2 * i + 1] = mix(points[a + 1], points[b + 1], s);
  });
  return xy;
}

// The lines a shape draws, as vertex numbers: whole rings (wanted is null), or the edges
// with one code, joined into runs.
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
    // Begins behind an edge that is not drawn, so that the ring's end cuts no run in two.
    for (let k = gap + 1, run = null; k < gap + count && gap < count; k++) {
      if (!drawn(k)) { run = null; continue; }
      if (!run) lines.push({ closed: false, vertices: run = [first + k % count] });
      run.push(first + (k + 1) % count);
    }
    first += count;
  }
  return lines;
}

// Positions are rounded as they are, never as differences: what touches goes on touching.
function pathData(lines, xy, grid) {
  const scale = grid * 100;
  let text = "";
  for (const { vertices, closed } of lines) {
    let command = "M";
    for (const v of vertices) {
      text += command + Math.round(xy[2 * v] * scale) / 100 + " " + Math.round(xy[2 * v + 1] * scale) / 100;
      command = command === "M" ? "L" : " ";
    }
    if (closed) text += "Z";
  }
  return text;
}

function mixColour(a, b, t) {
  if (a === b || a === "none" || b === "none") return t < 0.5 ? a : b;
  const channel = (text, i) => parseInt(text.slice(i, i + 2), 16);
  return "#" + [1, 3, 5].map((i) =>
    Math.round(mix(channel(a, i), channel(b, i), t)).toString(16).padStart(2, "0")).join("");
}

// A seam is not stroked while its two sides touch: it fades in and out over a twentieth.
function seamOpacity(code, u) {
  const opening = code & 1 ? 20 * u : 1;
  const closing = code & 2 ? 20 * (1 - u) : 1;
  return thousandth(clamp(Math.min(opening, closing), 0, 1));
}

// A rest may last no time at all, yet it wins over both transitions that meet there.
function spanAt(spans, time) {
  return spans.find((span) => span.step !== null && span.start <= time && time <= span.end)
    ?? spans.find((span) => span.step === null && span.start <= time && time < span.end)
    ?? spans.at(-1);
}

function stepAt(steps, time) {
  return Math.max(0, steps.findLastIndex((step, i) =>
    i === 0 || time >= (steps[i - 1].end + step.start) / 2));
}

// Which labels have room: the last and, from the left, all that keep clear of the ones
// before; then the current one, in place of those it would cover.
function roomFor(boxes, current) {
  const apart = (a, b) => boxes[a].right <= boxes[b].left || boxes[b].right <= boxes[a].left;
  const shown = [];
  for (const i of [boxes.length - 1, ...boxes.keys()]) {
    if (shown.every((other) => apart(i, other))) shown.push(i);
  }
  return new Set([current, ...shown.filter((i) => apart(i, current))]);
}

// ---- the element ----

function make(name, attributes = {}, ...children) {
  const svg = ["g", "path", "svg"].includes(name);
  const element = svg ? document.createElementNS(SVG, name) : document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  element.append(...children);
  return element;
}

// Writing an attribute costs style and paint work even when nothing changed. null removes.
const written = new WeakMap();
function put(element, name, value) {
  if (!written.has(element)) written.set(element, {});
  const known = written.get(element);
  if (known[name] === value) return;
  known[name] = value;
  if (value === null) element.removeAttribute(name);
  else element.setAttribute(name, value);
}

// As media elements do.
function finite(value) {
  if (!Number.isFinite(Number(value))) throw new TypeError(`not a finite number: ${value}`);
  return Number(value);
}

class GeotweenMap extends HTMLElement {
  static parts = { decode, ease, isThere, verticesAt, linesOf, pathData, mixColour, seamOpacity, spanAt, stepAt, roomFor };

  loop = false;
  #data = { duration: 0, steps: [], spans: [], groups: [], slots: [], paints: [] };
  #tracks = [];
  #groups = [];
  #slots = [];
  #controls = null;
  #connection = null;
  #time = 0;
  #step = 0;
  #span = null;
  #texts = new Map();
  #paused = true;
  #rate = 1;
  // The clock: time is #from + (now - #since), so that no frame's rounding adds up.
  #from = 0;
  #since = null;
  #stamp = null;
  #told = -Infinity;
  #request = 0;

  get currentTime() { return this.#time; }
  set currentTime(value) {
    this.#show(finite(value));
    this.#rebase(this.#stamp);
    this.#tell("timeupdate");
  }
  get duration() { return this.#data.duration; }
  get paused() { return this.#paused; }
  get ended() { return !this.loop && this.#data.steps.length > 0 && this.#time >= this.duration; }
  get steps() { return this.#data.steps.map(({ label, start, end }) => ({ label, start, end })); }
  get currentStep() { return this.#step; }
  get playbackRate() { return this.#rate; }
  set playbackRate(value) {
    this.#rate = finite(value);
    this.#rebase(this.#stamp);
  }

  async play() {
    if (!this.#paused) return;
    if (this.ended) this.currentTime = 0;
    this.#setPaused(false);
    this.#run();
  }

  pause() {
    if (this.#paused) return;
    this.#halt();
    this.#setPaused(true);
  }

  connectedCallback() {
    this.#connection = new AbortController();
    const { signal } = this.#connection;
    const fresh = !this.#controls;
    if (fresh && !this.#build()) {
      // A script above the element sees it before its content has been read.
      const again = () => this.isConnected && this.connectedCallback();
      if (document.readyState === "loading") {
        document.addEventListener("DOMContentLoaded", again, { once: true, signal });
      }
      return;
    }
    // A hidden tab gets no frames; the time it was away must not count.
    document.addEventListener("visibilitychange", () => { this.#halt(); this.#run(); }, { signal });
    this.#controls.watch.observe(this.#controls.marks);
    const calm = matchMedia("(prefers-reduced-motion: reduce)").matches;
    if (fresh && !calm && this.#data.steps.length > 1) this.play();
    else this.#run();
  }

  disconnectedCallback() {
    this.#connection.abort();
    this.#controls?.watch.disconnect();
    this.#halt();
  }

  // ---- clock ----

  #run() {
    if (this.#paused || this.#request || !this.isConnected) return;
    this.#request = requestAnimationFrame(this.#tick);
  }

  #halt() {
    cancelAnimationFrame(this.#request);
    this.#request = 0;
    this.#rebase(null);
  }

  #rebase(stamp) {
    this.#from = this.#time;
    this.#since = this.#stamp = stamp;
  }

  #tick = (now) => {
    this.#request = requestAnimationFrame(this.#tick);
    this.#since ??= now;
    // A frame scrolled out of view gets no ticks either, and no event says so.
    const away = now - (this.#stamp ?? now) - 1000;
    if (away > 0) this.#since += away;
    this.#stamp = now;
    const { duration } = this;
    let time = this.#from + (now - this.#since) / 1000 * this.#rate;
    const over = this.#rate < 0 ? time < 0 : time >= duration;
    if (over && this.loop && duration > 0) {
      time = ((time % duration) + duration) % duration;
      this.#from = time;
      this.#since = now;
    }
    this.#show(time);
    if (over && !(this.loop && duration > 0)) {
      this.#tell("timeupdate");
      this.pause();
      if (this.ended) this.#tell("ended");
    } else if (now - this.#told >= 100) {
      this.#told = now;
      this.#tell("timeupdate");
    }
  };

  #tell(type, detail) {
    this.dispatchEvent(detail ? new CustomEvent(type, { detail }) : new Event(type));
  }

  #setPaused(paused) {
    this.#paused = paused;
    this.#showPaused();
    this.#tell(paused ? "pause" : "play");
  }

  // ---- picture ----

  #show(time) {
    this.#time = clamp(thousandth(time), 0, this.duration);
    const { spans, steps, groups } = this.#data;
    if (!spans.length) return;
    const span = spanAt(spans, this.#time);
    if (span !== this.#span) this.#texts.clear();
    this.#span = span;
    const length = span.step === null ? span.end - span.start : 0;
    const u = length > 0 ? (this.#time - span.start) / length : 0;
    const t = ease(this.#data.easing, u);
    groups.forEach(({ opacity: [a, b] }, i) => put(this.#groups[i], "opacity", thousandth(mix(a, b, t))));
    const shown = new Set();
    for (const shape of span.shapes) {
      if (shape.show && (u < shape.show[0] || u > shape.show[1])) continue;
      shown.add(shape.slot);
      this.#drawShape(shape, u, t);
    }
    this.#slots.forEach((slot, i) => put(slot, "visibility", shown.has(i) ? null : "hidden"));
    this.#showTime();
    const step = stepAt(steps, this.#time);
    if (step === this.#step) return;
    this.#step = step;
    this.#showStep();
    this.#tell("stepchange", { step });
  }

  #drawShape(shape, u, t) {
    const slot = this.#slots[shape.slot], { kind } = this.#data.slots[shape.slot];
    const [a, b] = shape.paint.map((i) => this.#data.paints[i]);
    put(slot, "d", this.#textOf(shape, kind, t));
    put(slot, "fill", mixColour(a.fill, b.fill, t));
    put(slot, "stroke", mixColour(a.stroke, b.stroke, t));
    put(slot, "stroke-width", thousandth(mix(a.width, b.width, t)));
    put(slot, "stroke-dasharray", (t < 0.5 ? a.dash : b.dash) || null);
    if (kind === "seam") put(slot, "stroke-opacity", seamOpacity(shape.code, u));
  }

  // What stands still becomes text once per span, what moves becomes text at every frame.
  #textOf(shape, kind, t) {
    const { grid } = this.#data;
    if (!this.#texts.has(shape)) {
      const wanted = { border: 0, seam: shape.code }[kind] ?? null;
      this.#texts.set(shape, [...summed(shape.tracks)].map((index) => ({
        track: this.#tracks[index], lines: linesOf(this.#tracks[index], wanted), text: null })));
    }
    return this.#texts.get(shape).filter(({ track }) => isThere(track, t)).map((part) => {
      if (part.text) return part.text;
      const text = pathData(part.lines, verticesAt(part.track, t), grid);
      if (part.track.still) part.text = text;
      return text;
    }).join("");
  }

  // ---- building ----

  #build() {
    const json = this.querySelector("script[type='application/json']");
    const figure = this.querySelector("svg");
    const stage = figure?.querySelector("g.stage");
    if (!json || !stage) return false;
    const data = JSON.parse(json.textContent);
    if (data.version !== 2) throw new RangeError("geotween-map reads keyframes of version 2");
    this.#data = data;
    this.#tracks = decode(data);
    this.loop = data.loop;
    this.#groups = data.groups.map(({ layer }) => make("g", { class: "layer", "data-layer": layer }));
    this.#slots = data.slots.map(({ group, kind, key }) => {
      const region = kind === "region";
      const path = make("path", {
        class: kind, "stroke-linejoin": "round",
        ...(region && { "data-layer": data.groups[group].layer }),
        ...((region || key) && { "data-key": key }),
      });
      this.#groups[group].append(path);
      return path;
    });
    stage.replaceChildren(...this.#groups);
    this.#buildControls(figure);
    this.#show(0);
    this.#showStep();
    this.#showPaused();
    return true;
  }

  #buildControls(figure) {
    const { steps, duration } = this.#data;
    const button = (name, press) => {
      const element = make("button", { type: "button", class: name, "aria-label": WORDS[name] },
        make("svg", { viewBox: "0 0 24 24", "aria-hidden": "true" }, make("path", { d: ICONS[name] })));
      element.addEventListener("click", press);
      return element;
    };
    const previous = button("previous", () => this.#goTo(this.#previous()));
    const play = button("play", () => this.#toggle());
    const next = button("next", () => this.#goTo(this.#next()));
    const range = make("input", {
      type: "range", class: "time", min: 0, max: duration, step: 0.01, "aria-label": WORDS.time });
    // The range's last whole hundredth may lie just short of the end.
    range.addEventListener("input", () => this.#moveTo(
      range.valueAsNumber + 0.01 > duration ? duration : range.valueAsNumber));
    // Arrow keys reach every step already; a tab stop for each would be in the way.
    const labels = steps.map((step, i) => {
      const label = make("button", { type: "button", class: "mark", tabindex: -1, title: step.label }, step.label);
      label.addEventListener("click", () => this.#goTo(i));
      return label;
    });
    const ticks = steps.map((step) => {
      const tick = make("span", { class: "tick" });
      tick.style.left = `${100 * step.start / (duration || 1)}%`;
      return tick;
    });
    const marks = make("div", { class: "marks" }, ...ticks, ...labels);
    // Unseen, every caption takes its room: the page does not jump from step to step.
    const text = ({ label, caption }) => [make("strong", {}, label), " ", make("span", {}, caption ?? "")];
    const caption = make("p", { class: "caption" });
    const sizers = steps.map((step) => make("p", { class: "sizer", "aria-hidden": "true" }, ...text(step)));
    const transport = make("div", { class: "transport" }, previous, play, next,
      make("div", { class: "timeline" }, range, marks));
    const element = make("div", { class: "controls" }, make("div", { class: "captions" }, caption, ...sizers));
    if (steps.length > 1) element.prepend(transport);
    const watch = new ResizeObserver(() => this.#measureMarks());
    this.#controls = { previous, play, next, range, labels, marks, caption, text, watch, boxes: null };
    // A clone of a playing element brings controls that nobody listens to.
    for (const old of this.querySelectorAll(":scope > .controls")) old.remove();
    figure.after(element);
    if (!this.hasAttribute("role")) this.setAttribute("role", "group");
    if (steps.length > 1) this.addEventListener("keydown", (event) => this.#press(event));
  }

  // ---- controls follow the picture ----

  #showTime() {
    const { previous, next, range } = this.#controls;
    range.value = this.#time;
    range.style.setProperty("--done", `${100 * this.#time / (this.duration || 1)}%`);
    // Not `disabled`, which would drop the focus of someone who steps to the end.
    put(previous, "aria-disabled", this.#previous() < 0 ? "true" : null);
    put(next, "aria-disabled", this.#next() < 0 ? "true" : null);
  }

  #showStep() {
    const { caption, text, labels, range } = this.#controls;
    const step = this.#data.steps[this.#step];
    if (!step) return;
    caption.replaceChildren(...text(step));
    range.setAttribute("aria-valuetext", WORDS.place(this.#step, step.label, labels.length));
    labels.forEach((label, i) => put(label, "aria-current", i === this.#step ? "step" : null));
    this.#placeMarks();
  }

  #showPaused() {
    const { play, caption } = this.#controls ?? {};
    if (!play) return;
    const name = this.#paused ? "play" : "pause";
    play.setAttribute("aria-label", WORDS[name]);
    play.querySelector("path").setAttribute("d", ICONS[name]);
    // Read aloud only what the reader asked for, not what plays by itself.
    caption.setAttribute("aria-live", this.#paused ? "polite" : "off");
  }

  #measureMarks() {
    const { labels, marks } = this.#controls;
    const room = marks.clientWidth;
    this.#controls.boxes = labels.map((label, i) => {
      const width = label.offsetWidth;
      const centre = room * this.#data.steps[i].start / (this.duration || 1);
      // The marks' box is narrower than the range by half a thumb on either side.
      const left = clamp(centre - width / 2, -10, Math.max(0, room - width + 10));
      label.style.left = `${left}px`;
      return { left, right: left + width };
    });
    this.#placeMarks();
  }

  #placeMarks() {
    const { labels, boxes } = this.#controls;
    if (!boxes?.length) return;
    const shown = roomFor(boxes, this.#step);
    labels.forEach((label, i) => { label.style.visibility = shown.has(i) ? "" : "hidden"; });
  }

  // ---- the reader's hand: who moves in time takes over, so the clock stops ----

  #previous() { return this.#data.steps.findLastIndex((step) => step.end < this.#time); }
  #next() { return this.#data.steps.findIndex((step) => step.start > this.#time); }
  #toggle() { if (this.#paused) this.play(); else this.pause(); }
  // Before the first step and after the last there is nowhere to go, yet the wish to stop counts.
  #goTo(step) { this.#moveTo(this.#data.steps[step]?.start ?? this.#time); }
  #moveTo(time) {
    this.pause();
    this.currentTime = time;
  }

  #press(event) {
    if (event.defaultPrevented || event.ctrlKey || event.altKey || event.metaKey) return;
    const onRange = event.target === this.#controls.range;
    if (event.key === " " && event.target.closest("button")) return;
    const toggle = () => event.repeat || this.#toggle();
    const back = () => this.#goTo(this.#previous());
    const on = () => this.#goTo(this.#next());
    const action = {
      " ": toggle, k: toggle, K: toggle,
      ArrowLeft: back, ArrowRight: on, PageUp: back, PageDown: on,
      Home: () => this.#goTo(0), End: () => this.#goTo(this.#data.steps.length - 1),
      // Elsewhere these two scroll the page.
      ...(onRange && { ArrowDown: back, ArrowUp: on }),
    }[event.key];
    if (!action) return;
    event.preventDefault();
    action();
  }
}

if (!customElements.get("geotween-map")) customElements.define("geotween-map", GeotweenMap);
}
