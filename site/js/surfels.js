// Surfels: a model of discs, and the lens through which it is seen.

import { Orbit, clamp, count, fit, imageOf, milliseconds, oncePerFrame, paperBehind, select, slider } from "./figure.js";

export class SurfelDemo {
  constructor(engine) {
    this.engine = engine;
    this.canvas = select("#surfel-figure");
    this.redraw = oncePerFrame(() => this.draw());
    this.orbit = new Orbit(this.canvas, this.redraw);
    this.canvas.addEventListener("click", (event) => this.focusAt(event));
    this.focus = slider("#surfel-focus", (v) => `${v > 0 ? "+" : ""}${v.toFixed(2)}`);
    this.aperture = slider("#surfel-aperture", (v) => v.toFixed(3));
    this.distance = slider("#surfel-distance", (v) => v.toFixed(1));
    this.discs = slider("#surfel-count", (v) => count(v));
    for (const { input } of [this.focus, this.aperture, this.distance]) input.addEventListener("input", this.redraw);
    this.discs.input.addEventListener("change", () => this.sample());
  }

  // Takes the model that the engine holds.
  setModel(facts) {
    this.orbit.frame(facts, this.distance.value);
    this.sample();
  }

  sample() {
    const { facts, ms } = this.engine.ask(["surfels", this.discs.value]);
    select("#surfel-made").textContent = `${count(facts.points[0])} discs in ${milliseconds(ms)}`;
    this.redraw();
  }

  draw() {
    const { orbit } = this;
    orbit.distance = this.distance.value * orbit.radius;
    const [width, height] = fit(this.canvas, orbit.isMoving);
    const aperture = this.aperture.value * orbit.radius;
    const focus = Math.max(orbit.distance + this.focus.value * orbit.radius, 0.05 * orbit.radius);
    const words = ["surfels-frame", width, height, ...orbit.eye, ...orbit.target, aperture, focus, ...paperBehind(this.canvas)];
    const { facts, pixels, ms } = this.engine.ask(words);
    this.canvas.getContext("2d").putImageData(imageOf(pixels, width, height), 0, 0);
    select("#surfel-time").textContent = `${count(facts.drawn[0])} discs drawn, ${count(facts.links[0])} of them for several, in ${milliseconds(ms)}`;
  }

  // A tap on the model: what is there becomes sharp.
  focusAt(event) {
    if (!this.orbit.wasTap) return;
    const box = this.canvas.getBoundingClientRect();
    const place = [
      ((event.clientX - box.left) / box.width) * this.canvas.width,
      ((event.clientY - box.top) / box.height) * this.canvas.height,
    ];
    const sides = [this.canvas.width, this.canvas.height];
    const pixel = place.map((value, axis) => clamp(Math.floor(value), 0, sides[axis] - 1));
    const [depth] = this.engine.ask(["surfels-depth", ...pixel]).facts.depth;
    if (!Number.isFinite(depth)) return;
    this.focus.value = (depth - this.orbit.distance) / this.orbit.radius;
    this.redraw();
  }

  recolor() {
    this.redraw();
  }
}
