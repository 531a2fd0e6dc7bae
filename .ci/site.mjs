// Asks the module of the page what `site/requests.txt` lists, and compares its replies with those of the native program:
// `node .ci/site.mjs site.wasm native-replies`. Used by `.ci/site`.
import { readFile } from "node:fs/promises";
import { Engine } from "../site/js/engine.js";

// What `close` replies may differ by: numbers relative to their size; bytes of pictures, at most, and in how many of them. Where a disc or a
// mean of points is on the edge of a tolerance, whole pixels change.
const NUMBERS = 1e-4;
const BYTES = 2;
const LARGER_BYTES = 0.002;

const [modulePath, nativePath] = process.argv.slice(2);
const engine = await Engine.create(await readFile(modulePath));
const native = await readFile(nativePath);
const list = await readFile(new URL("../site/requests.txt", import.meta.url), "utf8");

function split(reply) {
  const length = reply.readUInt32LE(0);
  return { facts: reply.subarray(4, 4 + length).toString(), pixels: reply.subarray(4 + length) };
}

function areNear(a, b) {
  const [x, y] = [Number(a), Number(b)];
  return a === b || Math.abs(x - y) <= NUMBERS * Math.max(1, Math.abs(x), Math.abs(y));
}

// What is wrong with a reply that should be close to another, or nothing.
function difference(ours, theirs) {
  const [a, b] = [ours, theirs].map((reply) => reply.facts.split(/\s+/));
  if (a.length !== b.length) return `${a.length} words of facts, natively ${b.length}`;
  const word = a.findIndex((_, i) => !areNear(a[i], b[i]));
  if (word >= 0) return `${a[word]}, natively ${b[word]}`;
  if (ours.pixels.length !== theirs.pixels.length) return "pictures of different sizes";
  const larger = ours.pixels.filter((byte, i) => Math.abs(byte - theirs.pixels[i]) > BYTES).length;
  return larger > LARGER_BYTES * ours.pixels.length && `${larger} of ${ours.pixels.length} bytes of the picture differ by more than ${BYTES}`;
}

let [at, same, close, equal] = [0, 0, 0, 0];
for (const line of list.split("\n").filter((l) => l && !l.startsWith("#"))) {
  const kind = line.slice(0, line.indexOf(" "));
  const request = line.slice(kind.length + 1).replaceAll("\\n", "\n");
  const ours = Buffer.from(engine.bytes(request));
  const theirs = native.subarray(at + 4, at + 4 + native.readUInt32LE(at));
  at += 4 + theirs.length;
  const isSame = ours.equals(theirs);
  const wrong = kind === "same" ? !isSame && "not the same bytes" : difference(split(ours), split(theirs));
  if (wrong) {
    console.error(`${line}: ${wrong}`);
    process.exitCode = 1;
  }
  if (process.env.VERBOSE) console.log(isSame ? "equal" : "close", line.slice(0, 70));
  kind === "same" ? same++ : close++;
  equal += kind !== "same" && isSame;
}
if (at !== native.length) throw new Error(`${native.length - at} bytes of native replies are left`);
console.log(`${same} replies with the same bytes as natively, ${close} close to it (of which ${equal} the same)`);
