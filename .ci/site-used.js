// Uses the page of demonstrations as a visitor would, and says what is wrong. `.ci/site` puts it at the end of the page.
const wrong = [];
const expect = (holds, what) => holds || wrong.push(what);
addEventListener("error", (event) => wrong.push(event.message));
addEventListener("unhandledrejection", (event) => wrong.push(String(event.reason)));
console.error = (text) => wrong.push(text);

const get = (name) => document.querySelector(name);
const text = (name) => get(name).textContent;

// Time in a browser without a screen jumps to the next event; the module is compiled meanwhile on a thread that needs real time.
const patience = () => new Promise((go) => {
  for (let i = 0, x = 1; i < 1e7; i++) x = (x * 16807) % 2147483647;
  setTimeout(go, 50);
});
async function until(holds, what) {
  for (let i = 0; i < 400 && !holds(); i++) await patience();
  expect(holds(), what);
}
// Two frames, as `.ci/site` makes them: what was asked for is drawn.
const frames = () => new Promise((go) => requestAnimationFrame(() => requestAnimationFrame(go)));

// A number that changes with any pixel, and how many colours there are.
function look(name) {
  const canvas = get(name);
  const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
  const pixels = new Uint32Array(data.buffer);
  return { sum: pixels.reduce((sum, pixel) => (Math.imul(sum, 31) + pixel) | 0, 0), colors: new Set(pixels).size, data };
}
const brightness = (name) => look(name).data.reduce((sum, byte) => sum + byte, 0);

async function changes(name, act, what) {
  const before = look(name).sum;
  act();
  await frames();
  expect(look(name).sum !== before, `${what} does not change ${name}`);
}

function pointer(element, type, [x, y]) {
  const options = { bubbles: true, cancelable: true, pointerId: 1, isPrimary: true, clientX: x, clientY: y };
  element.dispatchEvent(new PointerEvent(type, options));
}
// From one place within an element to another, both from 0 to 1.
function drag(element, moved, from, to) {
  const box = element.getBoundingClientRect();
  const at = ([x, y]) => [box.left + x * box.width, box.top + y * box.height];
  pointer(moved, "pointerdown", at(from));
  for (const share of [0.5, 1]) pointer(moved, "pointermove", at(from.map((value, i) => value + share * (to[i] - value))));
  pointer(moved, "pointerup", at(to));
}
function set(name, value) {
  get(name).value = value;
  for (const type of ["input", "change"]) get(name).dispatchEvent(new Event(type, { bubbles: true }));
}
const press = (element, key) => element.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true, cancelable: true }));

function sums() {
  const [sum, inside, , whole] = [...document.querySelectorAll("#polygon-facts dd")].map((dd) => Number(dd.textContent));
  expect(Math.abs(sum - inside) <= 1e-12 * Math.max(1, inside), `cells add up to ${sum}, the polygon has ${inside}`);
  return { sum, whole };
}

async function usePolygon() {
  const svg = get("#polygon-figure");
  const handle = () => document.querySelectorAll(".handle")[0];
  const opacities = () => [...document.querySelectorAll(".cell rect")].map((rect) => rect.style.fillOpacity).join();
  const [before, first] = [opacities(), sums()];
  drag(svg, handle(), [0.22, 0.26], [0.35, 0.4]);
  await frames();
  expect(opacities() !== before && sums().sum < first.sum, "a dragged corner changes areas");
  const label = handle().getAttribute("aria-label");
  press(handle(), "ArrowRight");
  await frames();
  expect(handle().getAttribute("aria-label") !== label, "arrow keys move a corner");
  drag(svg, handle(), [0.35, 0.4], [0, 0]);
  await frames();
  expect(sums().whole > sums().sum + 0.1, "what is beyond the grid is not counted in it");
  get("#polygon-star").click();
  await frames();
  const holed = sums().sum;
  set("#polygon-rule", "non-zero");
  await frames();
  expect(sums().sum > holed + 1, "the star's middle is inside by one rule only");
  get("#polygon-add").click();
  await frames();
  expect(document.querySelectorAll(".handle").length === 6 && Math.abs(sums().sum - sums().whole) < 1e-9, "a corner is added on an edge");
}

async function useSurfels() {
  const canvas = get("#surfel-figure");
  expect(look("#surfel-figure").colors > 50, "no model is drawn");
  await changes("#surfel-figure", () => drag(canvas, canvas, [0.5, 0.5], [0.7, 0.45]), "dragging");
  await changes("#surfel-figure", () => press(canvas, "ArrowLeft"), "an arrow key");
  await changes("#surfel-figure", () => set("#surfel-focus", 0.6), "the focus");
  await changes("#surfel-figure", () => set("#surfel-aperture", 0.2), "the aperture");
  await changes("#surfel-figure", () => set("#surfel-distance", 2.5), "the distance");
  const middle = canvas.getBoundingClientRect();
  const at = { clientX: middle.left + middle.width / 2, clientY: middle.top + middle.height / 2, bubbles: true };
  await changes("#surfel-figure", () => {
    drag(canvas, canvas, [0.5, 0.5], [0.5, 0.5]);
    canvas.dispatchEvent(new MouseEvent("click", at));
  }, "a tap on the model");
  expect(Number(get("#surfel-focus").value) < 0.6, "a tap focuses on the front");
}

async function useScans() {
  const canvas = get("#scan-figure");
  expect(look("#scan-figure").colors > 50, "no scans are drawn");
  await changes("#scan-figure", () => set("#scan-noise", 1.5), "noise");
  await changes("#scan-figure", () => set("#scan-gamma", 0.4), "γ");
  await changes("#scan-figure", () => drag(canvas, canvas, [0.5, 0.5], [0.3, 0.6]), "dragging");
  for (const kind of ["stations", "points"]) await changes("#scan-figure", () => set("#scan-look", kind), kind);
  await changes("#scan-figure", () => set("#scan-rays", 60), "fewer rays");
}

async function openModel() {
  const tetrahedron = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
  const give = (name, content) => {
    const list = new DataTransfer();
    list.items.add(new File([content], name));
    get("#model-file").files = list.files;
    get("#model-file").dispatchEvent(new Event("change"));
  };
  const before = ["#surfel-figure", "#scan-figure"].map((name) => look(name).sum);
  give("a tetrahedron.obj", tetrahedron);
  await until(() => text("#model-name").includes("4 triangles"), "a file is not opened");
  await frames();
  expect(["#surfel-figure", "#scan-figure"].every((name, i) => look(name).sum !== before[i]), "the model of a file is not drawn");
  give("broken.ply", "ply\nformat ascii 1.0\nelement vertex 9\nend_header\n");
  await until(() => !get("#problem").hidden && text("#problem").includes("broken.ply"), "nothing says that a file is broken");
  give("again.obj", tetrahedron);
  await until(() => get("#problem").hidden, "the problem stays");
}

async function useProbes() {
  const plan = get("#probe-plan");
  const beyond = () => Number(text("#probe-facts").match(/([\d.]+) % of the weight/)[1]);
  const bright = brightness("#probe-ball");
  await changes("#probe-ball", () => drag(plan, plan, [0.4, 0.4], [0.53, 0.3]), "dragging the ball");
  expect(brightness("#probe-ball") < 0.8 * bright, "behind the wall it is dark");
  expect(beyond() < 0.1, `${beyond()} % of the light comes through the wall`);
  await changes("#probe-ball", () => get("#probe-sight").click(), "not knowing walls");
  expect(beyond() > 1, "without distances nothing leaks: there is nothing to show");
  await changes("#probe-ball", () => set("#probe-height", 2), "the height");
  await changes("#probe-plan", () => press(plan, "ArrowDown"), "an arrow key");
  await changes("#probe-plan", () => get("#probe-walk").click(), "the walk");
}

async function useAll() {
  const made = ["#polygon-time", "#surfel-time", "#scan-time", "#probe-time"];
  await until(() => made.every((name) => text(name).includes("ms")), "a demonstration does not start");
  await frames();
  expect(document.documentElement.scrollWidth <= innerWidth, "wider than the window");
  await usePolygon();
  await useSurfels();
  await useScans();
  await useProbes();
  await openModel();
  expect(document.documentElement.scrollWidth <= innerWidth, "wider than the window in the end");
}

useAll()
  .catch((error) => wrong.push(error.stack))
  .finally(() => parent.postMessage(wrong.length ? wrong.join("; ") : "all well", "*"));
