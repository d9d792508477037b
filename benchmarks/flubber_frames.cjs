// What flubber draws. Standard input is {"times": [...], "calls": [[function, arguments], ...]};
// standard output a list with one entry for each call: its shapes, each a list of rings, one for
// each time, or null where flubber refuses the call.
"use strict";

const { readFileSync } = require("node:fs");
const flubber = require("flubber");

// Points, not path strings; all else is flubber's default.
const options = { string: false };

function shapes(name, args, times) {
  let found;
  try {
    found = flubber[name](...args, options);
  } catch (error) {
    console.error(`flubber.${name}: ${error.message}`);
    return null;
  }
  return [found].flat().map((ring) => times.map(ring));
}

const { times, calls } = JSON.parse(readFileSync(0, "utf8"));
console.log(JSON.stringify(calls.map(([name, args]) => shapes(name, args, times))));
