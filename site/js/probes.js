// Probes: a ball in two rooms, lit by what probes around it hold.

import { capture, clamp, fit, imageOf, milliseconds, oncePerFrame, paperBehind, select, slider } from "./figure.js";

// Least distance of the ball's middle from walls, metres.
const MARGIN = 0.12;
// A walk from the lamp to the dark corner behind the wall: places in the plan, and milliseconds.
const WALK = [[0.8, 0.8], [2.2, 2.9], [4, 3.05], [5.2, 2.9], [6.8, 1.6], [4.5, 0.7]];
const WALK_MS = 7000;

export class ProbeDemo {
  constructor(engine) {
    this.engine = engine;
    this.plan = select("#probe-plan");
    this.ball = select("#probe-ball");
    this.place = [3.0, 1.5];
    this.redraw = oncePerFrame(() => this.draw());
    this.height = slider("#probe-height", (v) => `${v.toFixed(1)} m`);
    this.height.input.addEventListener("input", this.redraw);
    select("#probe-sight").addEventListener("change", this.redraw);
    select("#probe-walk").addEventListener("click", () => this.walk());
    this.listen();
  }

  listen() {
    this.plan.addEventListener("pointerdown", (event) => {
      capture(this.plan, event);
      this.isDragged = true;
      this.dragTo(event);
    });
    this.plan.addEventListener("pointermove", (event) => this.isDragged && this.dragTo(event));
    for (const end of ["pointerup", "pointercancel"]) this.plan.addEventListener(end, () => (this.isDragged = false));
    this.plan.addEventListener("keydown", (event) => this.press(event));
  }

  // Computes the light in the rooms and what probes see of it.
  start() {
    const [width, height] = fit(this.plan, false);
    const { facts, pixels, ms } = this.engine.ask(["rooms", width, height, ...paperBehind(this.plan)]);
    this.facts = facts;
    this.floor = document.createElement("canvas");
    Object.assign(this.floor, { width, height });
    this.floor.getContext("2d").putImageData(imageOf(pixels, width, height), 0, 0);
    const probes = facts.probes.length / 3;
    select("#probe-made").textContent = `light between ${facts.patches[0]} patches, seen by ${probes} probes, in ${milliseconds(ms)}`;
    this.draw();
  }

  dragTo(event) {
    this.isWalking = false;
    const box = this.plan.getBoundingClientRect();
    const [width, depth] = this.facts.plan;
    this.moveTo([((event.clientX - box.left) / box.width) * width, ((event.clientY - box.top) / box.height) * depth]);
  }

  press(event) {
    const steps = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
    if (!steps[event.key]) return;
    event.preventDefault();
    this.isWalking = false;
    const size = event.shiftKey ? 0.5 : 0.1;
    const [x, z] = this.place.map((value, axis) => value + size * steps[event.key][axis]);
    this.moveTo([x, z], this.place[0] < this.facts.wall[0]);
  }

  // To a place, or to the nearest beside the walls. What would stand in the wall stays in its room, or goes to the nearer one.
  moveTo([x, z], isInFirst) {
    const { plan, wall, door } = this.facts;
    this.place = [clamp(x, MARGIN, plan[0] - MARGIN), clamp(z, MARGIN, plan[1] - MARGIN)];
    const isInDoor = this.place[1] > door[0] + MARGIN && this.place[1] < door[1] - MARGIN;
    const isInWall = this.place[0] > wall[0] - MARGIN && this.place[0] < wall[1] + MARGIN;
    if (isInWall && !isInDoor) {
      const first = isInFirst ?? this.place[0] < 0.5 * (wall[0] + wall[1]);
      this.place[0] = first ? wall[0] - MARGIN : wall[1] + MARGIN;
    }
    this.redraw();
  }

  walk() {
    this.isWalking = true;
    const begin = performance.now();
    const step = (now) => {
      if (!this.isWalking) return;
      const at = clamp((now - begin) / WALK_MS, 0, 1) * (WALK.length - 1);
      const [from, to] = [WALK[Math.floor(at)], WALK[Math.min(Math.floor(at) + 1, WALK.length - 1)]];
      this.place = from.map((value, axis) => value + (to[axis] - value) * (at % 1));
      this.draw();
      if (at < WALK.length - 1) requestAnimationFrame(step);
    };
    requestAnimationFrame(step);
  }

  draw() {
    if (!this.facts) return;
    const [side] = fit(this.ball, false);
    const sight = select("#probe-sight").checked ? "seen" : "blind";
    const [x, z] = this.place;
    const words = ["ball", x, this.height.value, z, sight, side, ...paperBehind(this.ball)];
    const { facts, pixels, ms } = this.engine.ask(words);
    this.ball.getContext("2d").putImageData(imageOf(pixels, side, side), 0, 0);
    this.drawPlan(facts);
    this.showFacts(facts, ms);
  }

  drawPlan({ shares, cell }) {
    fit(this.plan, false);
    const context = this.plan.getContext("2d");
    const scale = this.plan.width / this.facts.plan[0];
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.drawImage(this.floor, 0, 0, this.plan.width, this.plan.height);
    context.setTransform(scale, 0, 0, scale, 0, 0);
    this.drawWall(context);
    this.drawEdges(context, cell);
    for (let i = 0; i < shares.length; i += 2) this.drawShare(context, shares[i], shares[i + 1]);
    for (let i = 0; i < this.facts.probes.length / 3; i++) this.drawProbe(context, i);
    circle(context, this.place, 0.16);
    stroke(context, "#fff", 0.05);
    stroke(context, "#000", 0.02);
  }

  drawWall(context) {
    const { plan, wall, door } = this.facts;
    context.fillStyle = "#808890";
    context.fillRect(wall[0], 0, wall[1] - wall[0], door[0]);
    context.fillRect(wall[0], door[1], wall[1] - wall[0], plan[1] - door[1]);
  }

  // All edges faintly, and those of the tetrahedron that holds the ball.
  drawEdges(context, cell) {
    const { edges } = this.facts;
    const line = (a, b) => {
      context.beginPath();
      context.moveTo(...this.probe(a));
      context.lineTo(...this.probe(b));
    };
    for (let i = 0; i < edges.length; i += 2) {
      line(edges[i], edges[i + 1]);
      stroke(context, "rgb(255 255 255 / 12%)", 0.012);
    }
    cell.forEach((a, i) => cell.slice(i + 1).forEach((b) => {
      line(a, b);
      stroke(context, "rgb(120 200 255 / 80%)", 0.025);
    }));
  }

  // As wide as the share is large.
  drawShare(context, probe, share) {
    context.beginPath();
    context.moveTo(...this.place);
    context.lineTo(...this.probe(probe));
    stroke(context, this.isBeyond(probe) ? "#ff5a4d" : "#ffd24a", 0.01 + 0.16 * share);
  }

  drawProbe(context, i) {
    const color = this.facts.colors.slice(3 * i, 3 * i + 3);
    circle(context, this.probe(i), 0.07);
    context.fillStyle = `rgb(${color})`;
    context.fill();
    stroke(context, "rgb(255 255 255 / 70%)", 0.015);
  }

  // Upper probes a little up and to the left, or they would hide the lower ones.
  probe(i) {
    const [x, y, z] = this.facts.probes.slice(3 * i, 3 * i + 3);
    return y > 1.3 ? [x - 0.05, z - 0.09] : [x + 0.05, z + 0.04];
  }

  // Whether a probe is in the other room; one in the door is in both.
  isBeyond(i) {
    const [x] = this.facts.probes.slice(3 * i);
    const [near, far] = this.facts.wall;
    return this.place[0] <= near ? x >= far : this.place[0] >= far && x <= near;
  }

  showFacts({ shares, light }, ms) {
    let beyond = 0;
    for (let i = 0; i < shares.length; i += 2) if (this.isBeyond(shares[i])) beyond += shares[i + 1];
    const mean = light.map((channel) => channel.toFixed(3)).join(", ");
    select("#probe-facts").textContent = `irradiance ${mean}, from ${shares.length / 2} probes; ${(100 * beyond).toFixed(beyond > 0 && beyond < 0.001 ? 3 : 1)} % of the weight is of probes in the other room`;
    select("#probe-time").textContent = `ball lit in ${milliseconds(ms)}`;
  }

  // The wall and the probes keep their colours; the page shows around the ball.
  recolor() {
    this.redraw();
  }
}

function circle(context, [x, y], radius) {
  context.beginPath();
  context.arc(x, y, radius, 0, 2 * Math.PI);
}

function stroke(context, color, width) {
  context.strokeStyle = color;
  context.lineWidth = width;
  context.stroke();
}
