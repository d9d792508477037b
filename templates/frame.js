// In a frame the page tells how high it is, in the words of Datawrapper and of Pym.
{
const root = document.documentElement;
if (parent !== window && root.classList.contains("geotween")) {
  root.classList.add("framed");
  const name = location.pathname.split("/").pop().replace(/\.html?$/, "") || "geotween";
  const child = new URLSearchParams(location.search).get("childId");
  new ResizeObserver(() => {
    const height = Math.ceil(root.getBoundingClientRect().height);
    parent.postMessage({ "datawrapper-height": { [name]: height } }, "*");
    if (child !== null) parent.postMessage(["pym", child, "height", height].join("xPYMx"), "*");
  }).observe(root);
}
}
