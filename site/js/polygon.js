// A polygon over a grid: corners that are dragged, and the exact area in every cell.

import { capture, clamp, milliseconds, oncePerFrame, select } from "./figure.js";

const COLUMNS = 8;
const ROWS = 6;
// How far corners may leave the grid, in cells.
const BEYOND = 0.8;
const SHAPES = {
  plain: [[1.2, 1.1], [6.9, 0.6], [6.3, 4.9], [2.4, 5.3]],
  star: [[4, 0.3], [5.9, 5.6], [0.7, 2.2], [7.3, 2.2], [2.1, 5.6]],
};

export class PolygonDemo {
  constructor(engine) {
    this.engine = engine;
    this.svg = select("#polygon-figure");
    this.corners = structuredClone(SHAPES.plain);
    this.redraw = oncePerFrame(() => this.draw());
    this.makeCells();
    this.outline = this.svg.appendChild(svgElement("polygon", { class: "outline" }));
    this.handles = this.svg.appendChild(svgElement("g", {}));
    this.listen();
    this.makeHandles();
  }

  makeCells() {
    this.cells = [];
    for (let i = 0; i < COLUMNS * ROWS; i++) {
      const [x, y] = [i % COLUMNS, Math.floor(i / COLUMNS)];
      const group = this.svg.appendChild(svgElement("g", { class: "cell" }));
      const title = group.appendChild(svgElement("title", {}));
      const square = group.appendChild(svgElement("rect", { x, y, width: 1, height: 1 }));
      const text = group.appendChild(svgElement("text", { x: x + 0.5, y: y + 0.6 }));
      this.cells.push({ title, square, text });
    }
  }

  listen() {
    this.svg.addEventListener("pointermove", (event) => this.dragTo(event));
    for (const end of ["pointerup", "pointercancel"]) this.svg.addEventListener(end, () => (this.dragged = null));
    for (const [name, shape] of Object.entries(SHAPES)) {
      select(`#polygon-${name}`).addEventListener("click", () => this.setCorners(structuredClone(shape)));
    }
    select("#polygon-add").addEventListener("click", () => this.addCorner());
    select("#polygon-remove").addEventListener("click", () => this.setCorners(this.corners.slice(0, Math.max(3, this.corners.length - 1))));
    select("#polygon-rule").addEventListener("change", this.redraw);
  }

  setCorners(corners) {
    this.corners = corners;
    this.makeHandles();
  }

  // In the middle of the longest edge.
  addCorner() {
    const next = (i) => this.corners[(i + 1) % this.corners.length];
    const lengths = this.corners.map(([x, y], i) => Math.hypot(next(i)[0] - x, next(i)[1] - y));
    const longest = lengths.indexOf(Math.max(...lengths));
    const middle = this.corners[longest].map((value, axis) => 0.5 * (value + next(longest)[axis]));
    this.setCorners(this.corners.toSpliced(longest + 1, 0, middle));
  }

  makeHandles() {
    this.handles.replaceChildren();
    this.corners.forEach((_, i) => {
      const handle = svgElement("g", { class: "handle", tabindex: 0, role: "button", "aria-roledescription": "corner that can be moved" });
      // A finger needs more than the eye.
      handle.append(svgElement("circle", { r: 0.48, class: "reach" }), svgElement("circle", { r: 0.17 }));
      handle.addEventListener("pointerdown", (event) => {
        capture(handle, event);
        this.dragged = i;
      });
      handle.addEventListener("keydown", (event) => this.press(event, i));
      this.handles.append(handle);
    });
    this.redraw();
  }

  dragTo(event) {
    if (this.dragged == null) return;
    const box = this.svg.getBoundingClientRect();
    const { x, y, width, height } = this.svg.viewBox.baseVal;
    const at = [x + ((event.clientX - box.left) / box.width) * width, y + ((event.clientY - box.top) / box.height) * height];
    this.moveCorner(this.dragged, at);
  }

  press(event, i) {
    const steps = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
    if (!steps[event.key]) return;
    event.preventDefault();
    const size = event.shiftKey ? 0.5 : 0.05;
    this.moveCorner(i, this.corners[i].map((value, axis) => value + size * steps[event.key][axis]));
  }

  moveCorner(i, [x, y]) {
    this.corners[i] = [clamp(x, -BEYOND, COLUMNS + BEYOND), clamp(y, -BEYOND, ROWS + BEYOND)];
    this.redraw();
  }

  draw() {
    const rule = select("#polygon-rule").value;
    const { facts, ms } = this.engine.ask(["polygon", COLUMNS, ROWS, rule, ...this.corners.flat()]);
    this.outline.setAttribute("points", this.corners.join(" "));
    this.outline.setAttribute("fill-rule", rule === "even-odd" ? "evenodd" : "nonzero");
    this.corners.forEach(([x, y], i) => {
      const handle = this.handles.children[i];
      handle.setAttribute("transform", `translate(${x} ${y})`);
      handle.setAttribute("aria-label", `Corner ${i + 1} of ${this.corners.length} at column ${x.toFixed(2)}, row ${y.toFixed(2)}`);
    });
    this.showAreas(facts.areas);
    this.showSums(facts, ms);
  }

  showAreas(areas) {
    areas.forEach((area, i) => {
      const { title, square, text } = this.cells[i];
      square.style.fillOpacity = 0.75 * area;
      text.textContent = shortShare(area);
      title.textContent = `${area} of this cell`;
    });
  }

  showSums({ sum: [sum], inside: [inside], whole: [whole] }, ms) {
    const off = Math.abs(sum - inside);
    const rows = [
      ["the cells add up to", sum],
      ["the polygon within the grid, asked of one large cell", inside],
      ["difference", off === 0 ? "0" : off.toExponential(1)],
      ["the polygon, also beyond the grid", whole],
    ];
    select("#polygon-facts").replaceChildren(...rows.flatMap(([name, value]) => [element("dt", name), element("dd", value)]));
    select("#polygon-time").textContent = `${COLUMNS * ROWS} cells in ${milliseconds(ms)}`;
  }

  // Colours of the picture come from the style.
  recolor() {}
}

function svgElement(name, attributes) {
  const made = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  return made;
}

function element(name, text) {
  const made = document.createElement(name);
  made.textContent = text;
  return made;
}

// Two digits; what is nearly nothing or nearly full is not rounded to that.
function shortShare(area) {
  if (area === 0) return "";
  if (area === 1) return "1";
  if (area < 0.005) return ">0";
  return area > 0.995 ? "<1" : area.toFixed(2).slice(1);
}
