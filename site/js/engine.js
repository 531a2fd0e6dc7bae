// The module of WebAssembly: requests in, replies out (`src/lib.rs` says what they are).

// What a program without files and without an environment is told by its system (WASI, preview 1).
const OK = 0;
const NO_SUCH_FILE = 8;

// The system of the module: nothing but a console, a clock and random numbers. `memory()` is known only when the module is there.
function system(memory) {
  const view = () => new DataView(memory().buffer);
  const writeZeros = (...addresses) => {
    for (const address of addresses) view().setUint32(address, 0, true);
    return OK;
  };
  const known = {
    environ_sizes_get: writeZeros,
    args_sizes_get: writeZeros,
    environ_get: () => OK,
    args_get: () => OK,
    fd_prestat_get: () => NO_SUCH_FILE,
    clock_time_get(_clock, _precision, address) {
      view().setBigUint64(address, BigInt(Math.round(performance.now() * 1e6)), true);
      return OK;
    },
    random_get(address, length) {
      crypto.getRandomValues(new Uint8Array(memory().buffer, address, length));
      return OK;
    },
    // The message of a panic comes this way.
    fd_write(_file, list, count, written) {
      let text = "", length = 0;
      for (let i = 0; i < count; i++) {
        const [start, size] = [0, 4].map((offset) => view().getUint32(list + 8 * i + offset, true));
        text += new TextDecoder().decode(new Uint8Array(memory().buffer, start, size));
        length += size;
      }
      if (text.trim()) console.error(text.trim());
      view().setUint32(written, length, true);
      return OK;
    },
    proc_exit(code) {
      throw new Error(`the module ended with code ${code}`);
    },
  };
  return new Proxy(known, { get: (functions, name) => functions[name] ?? (() => NO_SUCH_FILE) });
}

// A reply as it comes: the length of its facts, the facts, the bytes of a picture.
function parseReply(bytes) {
  const length = new DataView(bytes.buffer).getUint32(0, true);
  const text = new TextDecoder().decode(bytes.subarray(4, 4 + length));
  const facts = {};
  for (const line of text.split("\n").filter(Boolean)) {
    const [name, ...words] = line.split(" ");
    facts[name] = name === "error" ? words.join(" ") : words.map(Number);
  }
  return { facts, pixels: bytes.subarray(4 + length) };
}

export class Engine {
  constructor(exports) {
    this.exports = exports;
  }

  static async create(bytes) {
    const compiled = await WebAssembly.compile(bytes);
    let exports;
    const functions = system(() => exports.memory);
    const imports = {};
    for (const { module, name } of WebAssembly.Module.imports(compiled)) (imports[module] ??= {})[name] = functions[name];
    exports = (await WebAssembly.instantiate(compiled, imports)).exports;
    exports._initialize?.();
    return new Engine(exports);
  }

  // The bytes of the reply to a request: text, and a file after it if there is one.
  bytes(line, file = new Uint8Array()) {
    const text = new TextEncoder().encode(file.length ? line + "\n" : line);
    const start = this.exports.site_request_address(text.length + file.length);
    const memory = new Uint8Array(this.exports.memory.buffer);
    memory.set(text, start);
    memory.set(file, start + text.length);
    const length = this.exports.site_answer();
    // The memory may have grown, which is another buffer; and a copy outlives the next request.
    const address = this.exports.site_reply_address();
    return new Uint8Array(this.exports.memory.buffer).slice(address, address + length);
  }

  // Facts, picture and milliseconds of the reply to a request; its error, if it has one, is thrown.
  ask(words, file) {
    const begin = performance.now();
    const reply = parseReply(this.bytes(words.join(" "), file));
    if (reply.facts.error) throw new Error(reply.facts.error);
    return { ...reply, ms: performance.now() - begin };
  }
}
