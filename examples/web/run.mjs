// Builds the page and serves it: `node run.mjs [--build] [--page] [--port N]`. `--build` serves nothing, `--page` leaves the module as it
// is. Needs Rust, its target wasm32-unknown-unknown
// (`rustup target add wasm32-unknown-unknown`) and Node.js 20. Nothing is installed outside this folder.
//
// Where rustup reaches no server, the standard library is built from its source, of the compiler's own version: a folder in
// RUST_SRC, which scripts/rust_src takes from Debian's packages; rustup's `rust-src`; or Debian's, installed.

import { execFileSync } from "node:child_process";
import { cpSync, createReadStream, existsSync, mkdirSync, readFileSync, rmSync, statSync, writeFileSync } from "node:fs";
import { createServer } from "node:http";
import { dirname, extname, join, normalize } from "node:path";
import { fileURLToPath } from "node:url";
import { gzipSync } from "node:zlib";

const here = dirname(fileURLToPath(import.meta.url));
const out = join(here, "dist");
const TARGET = "wasm32-unknown-unknown";

const run = (program, args, options = {}) => {
  console.log(`> ${program} ${args.join(" ")}`);
  execFileSync(program, args, { cwd: here, stdio: "inherit", ...options });
};
const ask = (program, args) => execFileSync(program, args, { cwd: here, encoding: "utf8" }).trim();

// What cargo needs besides to build for the target.
function target() {
  const sysroot = ask("rustc", ["--print", "sysroot"]);
  if (existsSync(join(sysroot, "lib/rustlib", TARGET, "lib"))) return { args: [], env: {} };
  const version = ask("rustc", ["--version"]).split(" ")[1];
  const places = [process.env.RUST_SRC, join(sysroot, "lib/rustlib/src/rust/library"), `/usr/src/rustc-${version}/library`];
  const library = places.find((place) => place && existsSync(join(place, "std/Cargo.toml")));
  if (!library) {
    throw new Error(
      `there is no standard library for ${TARGET}, and no source of it: \`rustup target add ${TARGET}\`, or set RUST_SRC to the `
      + `folder \`library\` of Rust ${version}'s source (scripts/rust_src)`,
    );
  }
  console.log(`the standard library is built from ${library}`);
  return {
    args: ["-Zbuild-std=std,panic_abort"],
    env: { RUSTC_BOOTSTRAP: "1", __CARGO_TESTS_ONLY_SRC_ROOT: library },
  };
}

// The page as it is served; `isPageOnly` keeps the module that was built last.
async function build(isPageOnly) {
  if (!isPageOnly) module();
  for (const file of ["index.html", "style.css"]) cpSync(join(here, "page", file), join(out, file));
  // There only now.
  const { build: bundle } = await import("esbuild");
  const shared = { bundle: true, minify: true, target: "es2022", logLevel: "warning", outdir: out };
  await bundle({ ...shared, entryPoints: [join(here, "page/main.js")], format: "esm" });
  await bundle({ ...shared, entryPoints: [join(here, "page/worker.js")], format: "iife" });
  writeFileSync(join(out, "LICENSE-three.txt"), readFileSync(join(here, "node_modules/three/LICENSE")));
  for (const file of ["treesynth.wasm", "main.js", "worker.js"]) {
    const bytes = readFileSync(join(out, file));
    console.log(`${file}: ${(bytes.length / 1e6).toFixed(2)} MB, ${(gzipSync(bytes).length / 1e6).toFixed(2)} MB compressed`);
  }
}

function module() {
  const { args, env } = target();
  run("cargo", ["build", "--release", "--locked", "--lib", "--target", TARGET, ...args], {
    env: {
      ...process.env,
      ...env,
      // 4 MB of stack, as a thread of Rust has 2.
      CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_RUSTFLAGS: "-C target-feature=+simd128,+bulk-memory -C link-arg=-zstack-size=4194304",
    },
  });
  run("npm", ["ci", "--no-audit", "--no-fund"], { shell: process.platform === "win32" });
  rmSync(out, { recursive: true, force: true });
  mkdirSync(out);
  const folder = process.env.CARGO_TARGET_DIR ?? join(here, "target");
  const whole = join(folder, TARGET, "release", "treesynth_web.wasm");
  const wasm = join(out, "treesynth.wasm");
  const features = ["--enable-simd", "--enable-bulk-memory", "--enable-nontrapping-float-to-int", "--enable-sign-ext",
    "--enable-mutable-globals", "--enable-reference-types", "--enable-multivalue"];
  run("node", [join(here, "node_modules/binaryen/bin/wasm-opt"), "-O3", ...features, whole, "-o", wasm]);
}

const TYPES = {
  ".html": "text/html; charset=utf-8", ".js": "text/javascript", ".css": "text/css", ".wasm": "application/wasm", ".txt": "text/plain",
};

// Serves the built page; resolves to the server.
export function serve(port) {
  const server = createServer((request, response) => {
    const path = normalize(decodeURIComponent(new URL(request.url, "http://localhost").pathname));
    const file = join(out, path.endsWith("/") ? join(path, "index.html") : path);
    if (!file.startsWith(out) || !existsSync(file) || !statSync(file).isFile()) {
      response.writeHead(404).end("not found");
      return;
    }
    response.writeHead(200, { "content-type": TYPES[extname(file)] ?? "application/octet-stream", "cache-control": "no-cache" });
    createReadStream(file).pipe(response);
  });
  return new Promise((resolve) => server.listen(port, "127.0.0.1", () => resolve(server)));
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  const port = process.argv.indexOf("--port");
  await build(process.argv.includes("--page"));
  if (!process.argv.includes("--build")) {
    const server = await serve(port > 0 ? Number(process.argv[port + 1]) : 8080);
    console.log(`http://localhost:${server.address().port}/`);
  }
}
