// Beside a map's frame on a site: makes the room for it as high as its page says that it is.
{
const frame = document.currentScript.previousElementSibling, most = 20000;
addEventListener("message", ({ source, data }) => {
  if (source !== frame.contentWindow) return;
  for (const told of Object.values(data?.["datawrapper-height"] ?? {})) {
    const height = Math.min(Number(told), most);
    if (height > 0) frame.parentElement.style.paddingBottom = `${height}px`;
  }
});
}
