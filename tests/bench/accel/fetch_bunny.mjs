// Writes the Stanford bunny (npm package bunny) with every triangle cut into sixteen, 58,784 in
// all, as build/models/bunny.obj.
//
//   node tests/bench/accel/fetch_bunny.mjs [folder]
import { execFileSync } from "node:child_process";
import { existsSync, mkdirSync, renameSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import path from "node:path";
import { fileURLToPath } from "node:url";

const VERSION = "1.0.1";

/// Cuts every triangle into four at the middles of its edges.
function subdivide({ positions, cells }) {
  const points = positions.map((p) => [...p]);
  const middles = new Map();
  const middle = (a, b) => {
    const key = a < b ? `${a} ${b}` : `${b} ${a}`;
    if (!middles.has(key)) {
      middles.set(key, points.length);
      points.push([0, 1, 2].map((k) => (points[a][k] + points[b][k]) / 2));
    }
    return middles.get(key);
  };
  const triangles = cells.flatMap(([a, b, c]) => {
    const [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
    return [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]];
  });
  return { positions: points, cells: triangles };
}

const root = path.resolve(path.dirname(fileURLToPath(import.meta.url)), "../../..");
const folder = path.resolve(process.argv[2] ?? path.join(root, "build", "models"));
const target = path.join(folder, "bunny.obj");
mkdirSync(folder, { recursive: true });
if (!existsSync(target)) {
  const manifest = path.join(folder, "package.json");
  if (!existsSync(manifest)) writeFileSync(manifest, '{"private": true}\n');
  execFileSync("npm", ["install", "--no-audit", "--no-fund", "--prefix", folder, `bunny@${VERSION}`],
    { stdio: ["ignore", "inherit", "inherit"] });
  const mesh = subdivide(subdivide(createRequire(manifest)("bunny")));
  const rows = mesh.positions.map((p) => `v ${p.map(Math.fround).join(" ")}\n`)
    .concat(mesh.cells.map((c) => `f ${c.map((i) => i + 1).join(" ")}\n`));
  writeFileSync(`${target}.part`, rows.join(""));
  renameSync(`${target}.part`, target);
}
console.log(target);
