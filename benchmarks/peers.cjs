// Times peers. Each line of standard input is {peer, from, to}, rings as [[x, y], ...]; `to` is a
// list of rings for "separate". Each line of output is the time of a processor, in ms, that the
// peer took until it can give any frame.
"use strict";

const { createInterface } = require("node:readline");
const flubber = require("flubber");
const { interpolatePath } = require("d3-interpolate-path");
const polymorph = require("polymorph-js");

// Points, not path strings, and none but the outline's own: the least that flubber can do.
const plain = { maxSegmentLength: Infinity, string: false };
const path = (ring) => "M" + ring.map((point) => point.join(" ")).join("L") + "Z";

// Those that take paths are given them, for that is what a page has.
const peers = {
  flubber: (from, to) => () => flubber.interpolate(from, to, plain),
  separate: (from, to) => () => flubber.separate(from, to, plain),
  "polymorph-js": (from, to) => {
    const paths = [path(from), path(to)];
    return () => polymorph.interpolate(paths);
  },
  "d3-interpolate-path": (from, to) => {
    const paths = [path(from), path(to)];
    return () => interpolatePath(paths[0], paths[1])(0.5);
  },
};

createInterface({ input: process.stdin }).on("line", (line) => {
  const { peer, from, to } = JSON.parse(line);
  const prepare = peers[peer](from, to);
  const start = process.cpuUsage();
  prepare();
  const spent = process.cpuUsage(start);
  console.log(JSON.stringify((spent.user + spent.system) / 1e3));
});
