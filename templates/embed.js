"use strict";
// For a site that shows a map: puts a frame in the place of the script that names it.
//   <script src="…/embed.js" data-map="map.html" data-title="…" data-height="600" async></script>
{
const { map, title, height } = document.currentScript.dataset;
const frame = document.createElement("iframe");
frame.src = new URL(map, document.currentScript.src);
frame.title = title;
frame.height = height;
frame.loading = "lazy";
Object.assign(frame.style, { display: "block", width: "100%", border: 0 });
addEventListener("message", ({ source, data }) => {
  if (source !== frame.contentWindow) return;
  for (const told of Object.values(data?.["datawrapper-height"] ?? {})) frame.height = Number(told) || height;
});
document.currentScript.after(frame);
}
