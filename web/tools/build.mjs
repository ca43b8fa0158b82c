// Builds the page into dist/: index.html, main.js, style.css, icon.svg. Names
// are fixed; the daemon answers with an ETag, so a new build is seen at once.
import { build } from "esbuild";
import { cp, mkdir, rm, stat } from "node:fs/promises";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const root = dirname(dirname(fileURLToPath(import.meta.url)));
const dist = join(root, "dist");
await rm(dist, { recursive: true, force: true });
await mkdir(dist, { recursive: true });
await build({
  entryPoints: [join(root, "src/main.ts"), join(root, "src/style.css")],
  outdir: dist,
  bundle: true,
  minify: true,
  format: "esm",
  target: ["chrome110", "firefox115", "safari16.4"],
  charset: "utf8",
  logLevel: "warning",
});
for (const name of ["index.html", "icon.svg"]) await cp(join(root, "src", name), join(dist, name));
for (const name of ["index.html", "main.js", "style.css", "icon.svg"]) {
  console.log(`dist/${name}  ${(await stat(join(dist, name))).size} bytes`);
}
