// Runs a program that was compiled for wasm32-wasip1, with the whole file system: `node .ci/wasi.mjs PROGRAM.wasm [ARGUMENT …]`.
import { readFile } from "node:fs/promises";
import { WASI } from "node:wasi";

const [program, ...rest] = process.argv.slice(2);
const wasi = new WASI({ version: "preview1", args: [program, ...rest], env: process.env, preopens: { "/": "/" } });
const imports = wasi.getImportObject();
// Functions of JavaScript around the native ones: Node.js 20 corrupts its own memory in some direct calls.
for (const [name, call] of Object.entries(imports.wasi_snapshot_preview1)) {
  imports.wasi_snapshot_preview1[name] = (...given) => call(...given);
}
const module = await WebAssembly.compile(await readFile(program));
process.exitCode = wasi.start(await WebAssembly.instantiate(module, imports));
