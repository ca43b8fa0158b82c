// Chromium, and what the tests ask of a page again and again.
import { strict as assert } from "node:assert";
import { createRequire } from "node:module";
import { fileURLToPath } from "node:url";

const require = createRequire(fileURLToPath(new URL("../../../web/package.json", import.meta.url)));
const { chromium } = require("playwright-core");

export const kPatienceMs = 60_000 * Number(process.env.RAYKILN_SLOW ?? 1);

export const launch = () => chromium.launch({
  executablePath: process.env.RAYKILN_CHROMIUM ?? "/usr/bin/chromium",
  timeout: kPatienceMs,
  args: ["--no-sandbox", "--disable-gpu", "--disable-background-networking", "--disable-component-update", "--disable-sync", "--no-first-run"],
});

/** A fresh tab that remembers every complaint; refused requests are the tests' own doing. */
export async function open_tab(browser, url, path = "/", viewport = { width: 1280, height: 800 }) {
  const context = await browser.newContext({ viewport, reducedMotion: "reduce" });
  const page = await context.newPage();
  page.setDefaultTimeout(kPatienceMs);
  const complaints = [];
  page.on("pageerror", (error) => complaints.push(`exception: ${error.message}`));
  page.on("console", (message) => {
    const text = message.text();
    if (message.type() === "error" && !text.startsWith("Failed to load resource")) complaints.push(text);
  });
  await page.goto(url + path);
  return { page, complaints, close: () => context.close() };
}

export async function upload(page, files) {
  await page.setInputFiles("#pick-files", files);
  await page.locator(".upload-status", { hasText: "ready" }).first().waitFor();
}

/** Fills the form; keys are those of the fields. */
export async function fill(page, values) {
  for (const [key, value] of Object.entries(values)) {
    const field = page.locator(`#field-${key}`);
    if (!(await field.isVisible())) await page.getByText("More settings").click();
    await field.fill(String(value));
  }
}

/** Uploads the files, submits, and returns the job's id. */
export async function begin_job(page, files, values) {
  await upload(page, files);
  await fill(page, values);
  await page.getByRole("button", { name: "Render", exact: true }).click();
  await page.waitForURL(/\/jobs\/[^/]+$/);
  return page.url().split("/").pop();
}

export const state_is = (page, state) =>
  page.locator(`.panel .chip[data-state="${state}"]`).waitFor();

/** Mean of all channels (0..255) and the share of pixels that are not black. */
export const measure = (page) => page.locator(".stage canvas").evaluate((canvas) => {
  const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
  let sum = 0;
  let lit = 0;
  for (let at = 0; at < data.length; at += 4) {
    const value = data[at] + data[at + 1] + data[at + 2];
    sum += value / 3;
    if (value > 0) lit += 1;
  }
  return { mean: sum / (data.length / 4), lit: lit / (data.length / 4), width: canvas.width, height: canvas.height };
});

export const picture = (page) => page.locator(".stage canvas:not([hidden])").waitFor();

/** Waits until `probe` gives a value that `wanted` accepts. */
export async function until(probe, wanted, what) {
  const deadline = Date.now() + kPatienceMs;
  let value;
  do {
    value = await probe();
    if (wanted(value)) return value;
    await new Promise((resolve) => setTimeout(resolve, 40));
  } while (Date.now() < deadline);
  assert.fail(`${what}; last value: ${JSON.stringify(value)}`);
}

/** Controls without a name, doubled ids, and pictures without a text: what a screen reader stumbles over. */
export const label_faults = (page) => page.evaluate(() => {
  const faults = [];
  const visible = (element) => element.getClientRects().length > 0;
  const text_of = (ids) => ids.split(/\s+/).map((id) => document.getElementById(id)?.textContent ?? "").join(" ");
  const name_of = (element) =>
    element.getAttribute("aria-label") || text_of(element.getAttribute("aria-labelledby") ?? "") ||
    [...(element.labels ?? [])].map((label) => label.textContent).join(" ") ||
    (/^(BUTTON|A|SUMMARY|OPTION)$/.test(element.tagName) ? element.textContent : "");
  const controls = "a[href], button, input, select, textarea, summary, progress:not([aria-hidden]), [tabindex='0'], [role='region'], canvas";
  for (const element of document.querySelectorAll(controls)) {
    if (visible(element) && !name_of(element).trim()) faults.push(`no name: ${element.outerHTML.slice(0, 120)}`);
  }
  for (const element of document.querySelectorAll("img:not([alt])")) faults.push(`no alt: ${element.outerHTML.slice(0, 120)}`);
  const ids = [...document.querySelectorAll("[id]")].map((element) => element.id);
  for (const id of ids) if (ids.indexOf(id) !== ids.lastIndexOf(id)) faults.push(`id twice: ${id}`);
  for (const element of document.querySelectorAll("[aria-describedby], label[for]")) {
    const named = (element.getAttribute("aria-describedby") ?? element.getAttribute("for")).split(" ");
    for (const id of named) if (!document.getElementById(id)) faults.push(`points nowhere: ${id}`);
  }
  if ([...document.querySelectorAll("h1")].filter(visible).length !== 1) faults.push("not exactly one h1");
  if ([...document.querySelectorAll("main")].filter(visible).length !== 1) faults.push("not exactly one main");
  if (!document.documentElement.lang) faults.push("no language");
  return faults;
});
