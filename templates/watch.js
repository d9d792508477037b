"use strict";
// In pages of `geotween watch` only: loads the page anew when it was built, and shows errors.
{
const { page, version } = document.currentScript.dataset;
const KEPT = `geotween ${page}`;
let note;

function player() {
  return document.querySelector("geotween-map");
}

// The place and the state that the player was left in go on after a reload.
function leave() {
  const map = player();
  if (map) sessionStorage.setItem(KEPT, JSON.stringify([map.currentTime, map.paused]));
  location.reload();
}

function resume() {
  const kept = JSON.parse(sessionStorage.getItem(KEPT) ?? "null"), map = player();
  sessionStorage.removeItem(KEPT);
  if (!kept || !map?.pause) return;
  const [time, paused] = kept;
  map.currentTime = Math.min(time, map.duration);
  if (paused) map.pause();
}

function tell(error) {
  note?.remove();
  if (!error) return;
  note = document.createElement("pre");
  note.setAttribute("role", "alert");
  note.className = "geotween-error";
  note.textContent = error;
  Object.assign(note.style, {
    position: "fixed", inset: "auto 0 0 0", zIndex: 9, margin: 0, padding: "1rem 1.5rem",
    maxHeight: "60vh", overflow: "auto", background: "#5b1212", color: "#fff",
    font: "14px/1.5 ui-monospace, monospace", whiteSpace: "pre-wrap",
  });
  document.body.append(note);
}

resume();
new EventSource(`/geotween-watch?${encodeURIComponent(page)}`).onmessage = ({ data }) => {
  const news = JSON.parse(data);
  if (news.version === version) tell(news.error);
  else leave();
};
}
