// A scrolling story: each step of the map plays as its words arrive, forwards and backwards.
{
const LINE = 70; // percent of the window's height: words above it have arrived
const LONGEST = 2; // s until the map is at its step, however far away that was

class GeotweenStory extends HTMLElement {
  #map = null;
  #chapters = [];
  #steps = [];
  #sight = null;
  #still = matchMedia("(prefers-reduced-motion: reduce)");
  #goal = 0;
  #rate = 1;
  #stamp = null;
  #request = 0;

  connectedCallback() {
    if (document.readyState === "loading") {
      document.addEventListener("DOMContentLoaded", () => this.isConnected && this.#begin(), { once: true });
    } else this.#begin();
    this.#still.addEventListener("change", this.#begin);
    this.addEventListener("keydown", this.#leave, true);
  }

  disconnectedCallback() {
    this.#end();
    this.#still.removeEventListener("change", this.#begin);
    this.removeEventListener("keydown", this.#leave, true);
  }

  #begin = () => {
    this.#end();
    this.#map = this.querySelector("geotween-map");
    this.#steps = this.#map.steps;
    this.#chapters = [...this.querySelectorAll(".chapter")];
    // A frame as high as its page does not scroll.
    const scrolls = !this.#still.matches && parent === window;
    this.classList.toggle("scrolls", scrolls);
    if (!scrolls) return;
    this.#map.pause();
    this.#map.currentTime = this.#steps[this.#look()].start;
    this.#sight = new IntersectionObserver(() => this.#goTo(this.#look()), {
      rootMargin: `-${LINE}% 0px -${100 - LINE}% 0px` });
    for (const chapter of this.#chapters) this.#sight.observe(chapter);
  };

  #end() {
    this.#sight?.disconnect();
    cancelAnimationFrame(this.#request);
    this.#request = 0;
  }

  // The keys of the player scroll here, but for those that lead through its regions.
  #leave = (event) => {
    if (this.#sight && !/^(n|escape)$/i.test(event.key)) event.stopPropagation();
  };

  // The step whose words arrived last.
  #look() {
    const line = innerHeight * LINE / 100;
    const arrived = this.#chapters.findLastIndex((chapter) => chapter.getBoundingClientRect().top <= line);
    const current = Math.max(arrived, 0);
    this.#chapters.forEach((chapter, i) => {
      if (i === current) chapter.setAttribute("aria-current", "step");
      else chapter.removeAttribute("aria-current");
    });
    return current;
  }

  #goTo(step) {
    const { start, end } = this.#steps[step], time = this.#map.currentTime;
    this.#goal = Math.min(Math.max(time, start), end);
    if (this.#goal === time) return;
    const rest = this.#steps.find((other) => other.start <= time && time <= other.end);
    if (rest) this.#map.currentTime = time < start ? rest.end : rest.start;
    this.#rate = Math.max(1, Math.abs(this.#goal - this.#map.currentTime) / LONGEST);
    if (!this.#request) {
      this.#stamp = null;
      this.#request = requestAnimationFrame(this.#tick);
    }
  }

  #tick = (now) => {
    const passed = Math.min(now - (this.#stamp ?? now), 100) / 1000 * this.#rate;
    const left = this.#goal - this.#map.currentTime;
    this.#stamp = now;
    this.#map.currentTime += Math.sign(left) * Math.min(passed, Math.abs(left));
    this.#request = this.#map.currentTime === this.#goal ? 0 : requestAnimationFrame(this.#tick);
  };
}

if (!customElements.get("geotween-story")) customElements.define("geotween-story", GeotweenStory);
}
