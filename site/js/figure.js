// What the demonstrations have in common: canvases, redrawing, cameras that orbit, numbers as text.

export const select = (name) => document.querySelector(name);

export const clamp = (value, low, high) => Math.min(Math.max(value, low), high);

// Lets a finger leave what it moves. Only pointers that are there can be captured, not those of events made by a script.
export function capture(element, event) {
  if (event.isTrusted) element.setPointerCapture(event.pointerId);
}

// A function that draws once a frame, however often it is called.
export function oncePerFrame(draw) {
  let isAsked = false;
  return () => {
    if (isAsked) return;
    isAsked = true;
    requestAnimationFrame(() => {
      isAsked = false;
      draw();
    });
  };
}

// The colour behind an element: red, green, blue, as requests take it.
export function paperBehind(element) {
  return getComputedStyle(element).backgroundColor.match(/\d+/g).slice(0, 3);
}

// Gives a canvas as many pixels as the screen has for it, at most two by two for one of the page, and says how many.
export function fit(canvas, isMoving) {
  const ratio = isMoving ? 1 : Math.min(devicePixelRatio, 2);
  const { width, height } = canvas.getBoundingClientRect();
  const [columns, rows] = [width, height].map((side) => clamp(Math.round(side * ratio), 1, 1600));
  if (canvas.width !== columns || canvas.height !== rows) Object.assign(canvas, { width: columns, height: rows });
  return [columns, rows];
}

export function imageOf(pixels, width, height) {
  return new ImageData(new Uint8ClampedArray(pixels.buffer, pixels.byteOffset, pixels.length), width, height);
}

export const count = (number) => number.toLocaleString("en");

export const milliseconds = (ms) => `${ms < 10 ? ms.toFixed(1) : Math.round(ms)} ms`;

// The value of a slider, which is shown beside it.
export function slider(name, show) {
  const input = select(name);
  const output = input.parentElement.querySelector("output");
  const update = () => (output.textContent = show(input.valueAsNumber));
  input.addEventListener("input", update);
  update();
  return {
    input,
    get value() {
      return input.valueAsNumber;
    },
    set value(number) {
      input.value = number;
      update();
    },
  };
}

// A camera that goes around a model by pointer and keys. `changed(isMoving)` is called for every move.
export class Orbit {
  constructor(canvas, changed) {
    Object.assign(this, { canvas, changed, yaw: 0.6, pitch: 0.35, distance: 1, target: [0, 0, 0], isMoving: false });
    this.drag = null;
    canvas.addEventListener("pointerdown", (event) => this.begin(event));
    canvas.addEventListener("pointermove", (event) => this.move(event));
    for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, () => this.end());
    canvas.addEventListener("keydown", (event) => this.press(event));
  }

  // Looks at all of a box from a distance of so many times its half diagonal.
  frame({ low, high }, factor) {
    this.target = low.map((value, axis) => 0.5 * (value + high[axis]));
    this.radius = 0.5 * Math.hypot(...low.map((value, axis) => high[axis] - value));
    this.distance = factor * this.radius;
  }

  get eye() {
    const [sideways, level] = [this.yaw, this.pitch];
    const way = [Math.sin(sideways) * Math.cos(level), Math.sin(level), Math.cos(sideways) * Math.cos(level)];
    return this.target.map((value, axis) => value + this.distance * way[axis]);
  }

  begin(event) {
    capture(this.canvas, event);
    this.drag = { x: event.clientX, y: event.clientY, travelled: 0 };
  }

  move(event) {
    if (!this.drag) return;
    const [dx, dy] = [event.clientX - this.drag.x, event.clientY - this.drag.y];
    const travelled = this.drag.travelled + Math.hypot(dx, dy);
    this.drag = { x: event.clientX, y: event.clientY, travelled };
    this.isMoving = true;
    this.turn(-dx * 0.01, dy * 0.01);
  }

  end() {
    if (!this.drag) return;
    // Less than this is a tap with a finger that trembles.
    this.wasTap = this.drag.travelled < 6;
    this.drag = null;
    this.isMoving = false;
    this.changed();
  }

  press(event) {
    const turns = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, 0.1], ArrowDown: [0, -0.1] };
    if (!turns[event.key]) return;
    event.preventDefault();
    this.turn(...turns[event.key]);
  }

  turn(yaw, pitch) {
    this.yaw += yaw;
    this.pitch = clamp(this.pitch + pitch, -1.4, 1.4);
    this.changed();
  }
}
