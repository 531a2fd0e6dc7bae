// Range scans: raw points of nine noisy scans, drawn as a surface.

import { Orbit, count, fit, imageOf, milliseconds, oncePerFrame, paperBehind, select, slider } from "./figure.js";

// How far the camera is from the model, in half diagonals of its box.
const DISTANCE = 3;

export class ScanDemo {
  constructor(engine) {
    this.engine = engine;
    this.canvas = select("#scan-figure");
    this.redraw = oncePerFrame(() => this.draw());
    this.rescan = oncePerFrame(() => this.scan());
    this.orbit = new Orbit(this.canvas, this.redraw);
    this.noise = slider("#scan-noise", (v) => `±${v.toFixed(2)}`);
    this.gamma = slider("#scan-gamma", (v) => v.toFixed(1));
    this.rays = slider("#scan-rays", (v) => count(v));
    this.look = select("#scan-look");
    this.noise.input.addEventListener("input", this.rescan);
    this.rays.input.addEventListener("change", this.rescan);
    for (const input of [this.gamma.input, this.look]) input.addEventListener("input", this.redraw);
  }

  // Takes the model that the engine holds, unless there is nothing that rays could meet.
  setModel(facts) {
    this.hasSurface = facts.triangles[0] > 0;
    this.orbit.frame(facts, DISTANCE);
    this.scan();
  }

  scan() {
    if (!this.hasSurface) {
      select("#scan-made").textContent = "This model has points only; there is no surface to scan.";
      return;
    }
    const { facts, ms } = this.engine.ask(["scans", this.rays.value, this.noise.value]);
    select("#scan-made").textContent = `9 scans, ${count(facts.points[0])} points, in ${milliseconds(ms)}`;
    this.draw();
  }

  draw() {
    if (!this.hasSurface) return;
    const { orbit } = this;
    const [width, height] = fit(this.canvas, orbit.isMoving);
    const words = ["scans-frame", width, height, ...orbit.eye, ...orbit.target, this.look.value, this.gamma.value];
    const { facts, pixels, ms } = this.engine.ask([...words, ...paperBehind(this.canvas)]);
    this.canvas.getContext("2d").putImageData(imageOf(pixels, width, height), 0, 0);
    const buffer = facts.pixel ? `, averaged in pixels of ${facts.pixel[0].toFixed(1)}` : "";
    select("#scan-time").textContent = `drawn in ${milliseconds(ms)}${buffer}`;
  }

  recolor() {
    this.redraw();
  }
}
