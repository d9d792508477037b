// Times flubber. Each line of standard input is a pair of rings, [[[x, y], ...], [[x, y], ...]];
// each line of output is the time, in ms, that flubber took to prepare that pair.
"use strict";

const { createInterface } = require("node:readline");
const { performance } = require("node:perf_hooks");
const { interpolate } = require("flubber");

// Points, not path strings, and none but the outline's own: the least that flubber can do.
const options = { maxSegmentLength: Infinity, string: false };

createInterface({ input: process.stdin }).on("line", (line) => {
  const [from, to] = JSON.parse(line);
  const start = performance.now();
  interpolate(from, to, options);
  console.log(JSON.stringify(performance.now() - start));
});
