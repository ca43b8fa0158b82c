// The page in headless Chromium. Usage:
//   node tests/e2e/page/run.mjs                   starts raykilnd itself (preset "test")
//   node tests/e2e/page/run.mjs --preset release  another build
//   node tests/e2e/page/run.mjs --server URL      against a running server
//   node tests/e2e/page/run.mjs --mock            against the mock server alone
//   ... --only TEXT                               tests whose name holds TEXT
// Needs web/dist and web/node_modules (npm ci && npm run build in web/). The odd
// cases always run against the mock. The last line is "N passed, N failed".
import { existsSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { parseArgs } from "node:util";
import { launch } from "./browser.mjs";
import { Mock } from "./mock.mjs";
import { kOddTests } from "./odd_tests.mjs";
import { kPageTests } from "./page_tests.mjs";
import { Daemon } from "./server.mjs";

const root = join(dirname(fileURLToPath(import.meta.url)), "../../..");
const { values: options } = parseArgs({
  options: {
    server: { type: "string" }, preset: { type: "string", default: "test" }, mock: { type: "boolean", default: false },
    only: { type: "string", default: "" },
  },
});
const dist = join(root, "web/dist");
const programs = process.env.RAYKILN_BIN_DIR ?? join(root, "build", options.preset, "bin");
const tally = { passed: 0, failed: 0 };

async function run(group, tests, world) {
  for (const [name, body] of tests) {
    if (!name.includes(options.only)) continue;
    const begun = Date.now();
    try {
      await body(world);
      tally.passed += 1;
      console.log(`ok    ${group}: ${name} (${Date.now() - begun} ms)`);
    } catch (error) {
      tally.failed += 1;
      console.log(`FAIL  ${group}: ${name}\n      ${String(error?.stack ?? error).replaceAll("\n", "\n      ")}`);
    }
  }
}

/** A server to test the page against: { url, close }. */
async function server() {
  if (options.server) return { url: options.server.replace(/\/$/, ""), close: async () => undefined };
  if (options.mock) {
    const mock = new Mock(dist, 1.5);
    return { url: await mock.listen(), close: () => mock.close() };
  }
  const daemon = new Daemon(join(programs, "raykilnd"));
  const close = async () => {
    await daemon.stop();
    daemon.discard();
  };
  try {
    return { url: await daemon.start(), close };
  } catch (error) {
    await close();
    throw error;
  }
}

async function whole(name, body) {
  try {
    await body();
  } catch (error) {
    tally.failed += 1;
    console.log(`FAIL  ${name}: ${error?.stack ?? error}`);
  }
}

await whole("start", async () => {
  if (!existsSync(join(dist, "index.html"))) throw new Error("web/dist is not built: npm ci && npm run build in web/");
  const browser = await launch();
  await whole("server", async () => {
    const { url, close } = await server();
    await run("page", kPageTests, { browser, url, dist });
    await close();
  });
  await run("odd", kOddTests, { browser, dist });
  await browser.close();
});
console.log(`${tally.passed} passed, ${tally.failed} failed`);
process.exitCode = tally.failed === 0 ? 0 : 1;
