// Starts the demonstrations when they come into sight, and hands them the visitor's model.

import { Engine } from "./engine.js";
import { count, milliseconds, select } from "./figure.js";
import { PolygonDemo } from "./polygon.js";
import { SurfelDemo } from "./surfels.js";
import { ScanDemo } from "./scans.js";
import { ProbeDemo } from "./probes.js";

// More than this is a model for the command line: the page has one thread, and a phone little memory.
const LARGEST_FILE = 150e6;

class Page {
  constructor(engine) {
    this.engine = engine;
    this.demos = {
      polygon: new PolygonDemo(engine),
      surfels: new SurfelDemo(engine),
      scans: new ScanDemo(engine),
      probes: new ProbeDemo(engine),
    };
    this.started = new Set();
    this.model = engine.ask(["model", "rabbit"]).facts;
    this.startWhenSeen();
    this.takeFiles();
    this.followLooks();
  }

  startWhenSeen() {
    const seen = (entries, observer) => {
      for (const { isIntersecting, target } of entries) {
        if (!isIntersecting) continue;
        observer.unobserve(target);
        // The page is shown before the first picture is computed.
        setTimeout(() => this.start(target.id), 0);
      }
    };
    const observer = new IntersectionObserver(seen, { rootMargin: "200px" });
    for (const name of Object.keys(this.demos)) observer.observe(document.getElementById(name));
  }

  start(name) {
    this.started.add(name);
    const demo = this.demos[name];
    this.guarded(() => (demo.setModel ? demo.setModel(this.model) : demo.start?.()));
  }

  takeFiles() {
    const input = select("#model-file");
    input.addEventListener("change", () => input.files[0] && this.open(input.files[0]));
    for (const canvas of document.querySelectorAll("#surfels canvas, #scans canvas")) {
      canvas.addEventListener("dragover", (event) => event.preventDefault());
      canvas.addEventListener("drop", (event) => {
        event.preventDefault();
        if (event.dataTransfer.files[0]) this.open(event.dataTransfer.files[0]);
      });
    }
  }

  async open(file) {
    const bytes = new Uint8Array(await file.arrayBuffer());
    this.guarded(() => {
      if (file.size > LARGEST_FILE) throw new Error(`${file.name} has ${count(file.size)} bytes; this page takes up to ${count(LARGEST_FILE)}`);
      // Names are one word of a request.
      const { facts, ms } = this.engine.ask(["model", file.name.replaceAll(/\s/g, "_")], bytes);
      this.model = facts;
      select("#model-name").textContent = `${file.name}: ${count(facts.points[0])} vertices, ${count(facts.triangles[0])} triangles, read in ${milliseconds(ms)}`;
      for (const name of ["surfels", "scans"]) if (this.started.has(name)) this.demos[name].setModel(facts);
    });
  }

  // Pictures are drawn over the colour of the page, and as large as the window lets them be.
  followLooks() {
    const recolor = () => this.started.forEach((name) => this.demos[name].recolor());
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", recolor);
    addEventListener("resize", recolor);
    // Of pictures that are drawn later. A module that has stopped, for want of memory say, does not start again.
    addEventListener("error", ({ message }) => showProblem(`${message}. Reload the page to start anew.`));
  }

  // Says what went wrong instead of leaving a dead page.
  guarded(work) {
    try {
      work();
      showProblem("");
    } catch (error) {
      showProblem(error.message);
    }
  }
}

function showProblem(text) {
  const problem = select("#problem");
  problem.textContent = text;
  problem.hidden = !text;
}

function moduleBytes() {
  const text = atob(select("#module").textContent);
  return Uint8Array.from(text, (character) => character.charCodeAt(0));
}

try {
  new Page(await Engine.create(moduleBytes()));
} catch (error) {
  showProblem(`This page needs WebAssembly: ${error.message}`);
}
