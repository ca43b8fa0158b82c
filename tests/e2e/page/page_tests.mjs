// The page against any server: the real daemon, or the mock.
import { strict as assert } from "node:assert";
import {
  begin_job, fill, label_faults, measure, open_tab, picture, state_is, until, upload,
} from "./browser.mjs";
import { bad_files, box_files } from "./scene.mjs";

const kSmall = { width: 160, height: 120, samples: 8 };
/** Long enough to be cancelled by hand, on any machine. */
const kEndless = { width: 320, height: 240, samples: 200000 };

const with_tab = (body, path = "/") => async ({ browser, url }) => {
  const tab = await open_tab(browser, url, path);
  try {
    await body(tab.page, url, browser);
    assert.deepEqual(tab.complaints, []);
  } finally {
    await tab.close();
  }
};

/** A finished job that several tests look at; made once a server, by the API alone. */
const done_jobs = new Map();

async function done_job(url) {
  if (!done_jobs.has(url)) done_jobs.set(url, await render_by_api(url));
  return done_jobs.get(url);
}

async function render_by_api(url, more = {}) {
  const form = new FormData();
  for (const { name, buffer } of box_files("done")) form.append("file", new Blob([buffer]), name);
  const scene = await (await fetch(`${url}/v1/scenes`, { method: "POST", body: form })).json();
  const { samples, ...size } = kSmall;
  const answer = await fetch(`${url}/v1/jobs`, {
    method: "POST", headers: { "Content-Type": "application/json" },
    body: JSON.stringify({ scene: scene.id, name: "done", ...size, stop: { samples }, ...more }),
  });
  const { id } = await answer.json();
  const state = async () => (await (await fetch(`${url}/v1/jobs/${id}`)).json()).state;
  await until(state, (value) => value === "completed", "the job does not complete");
  return id;
}

export const kPageTests = [
  ["an upload by the picker reports what the scene holds", with_tab(async (page) => {
    await upload(page, box_files("picker"));
    const report = page.locator("form .facts").first();
    await report.getByText("Triangles", { exact: true }).waitFor();
    assert.match(await report.innerText(), /Materials/);
    assert.match(await page.locator("#field-scene option:checked").innerText(), /box/);
  })],

  ["an upload by drop anywhere on the page", with_tab(async (page) => {
    const files = box_files("drop").map(({ name, buffer }) => [name, buffer.toString()]);
    const transfer = await page.evaluateHandle((list) => {
      const data = new DataTransfer();
      for (const [name, text] of list) data.items.add(new File([text], name));
      return data;
    }, files);
    await page.dispatchEvent(".bar", "dragenter", { dataTransfer: transfer });
    assert.equal(await page.locator(".veil").isVisible(), true);
    await page.dispatchEvent(".bar", "drop", { dataTransfer: transfer });
    await page.locator(".upload-status", { hasText: "ready" }).waitFor();
    assert.equal(await page.locator(".veil").isVisible(), false);
  })],

  ["a job by the keyboard alone, watched to its end", with_tab(async (page) => {
    await upload(page, box_files("keyboard"));
    await page.keyboard.press("n"); // focus on the form
    const press_until = async (id) => {
      for (let step = 0; step < 30; step += 1) {
        if ((await page.evaluate(() => document.activeElement?.id)) === id) return;
        await page.keyboard.press("Tab");
      }
      assert.fail(`Tab does not reach ${id}`);
    };
    for (const [key, value] of Object.entries(kSmall)) {
      await press_until(`field-${key}`);
      await page.keyboard.press("Control+A");
      await page.keyboard.type(String(value));
    }
    await page.keyboard.press("Enter");
    await page.waitForURL(/\/jobs\//);
    assert.equal(await page.evaluate(() => document.activeElement?.tagName), "H1");
    await state_is(page, "completed");
    assert.match(await page.locator("#progress-text").innerText(), /^Done in /);
    assert.match(await page.locator(".panel .facts").first().innerText(), /8 \/ 8/);
  })],

  ["the effects of a scene have reasons, and what is left out by keyboard marks the job", with_tab(async (page) => {
    await upload(page, box_files("effects"));
    const of_scene = page.locator("form .effects-fold");
    await of_scene.locator("summary").focus();
    await page.keyboard.press("Enter");
    const line = (list, effect) => list.locator(`li[data-effect="${effect}"]`);
    assert.match(await line(of_scene, "point_lights").innerText(), /simulated[\s\S]*1 point light with power above 0/);
    assert.match(await line(of_scene, "refraction").innerText(), /left out[\s\S]*transparent[\s\S]*the picture is the same/);
    await fill(page, kSmall);
    await page.getByText("More settings").click();
    await page.locator("#field-effects").focus();
    await page.keyboard.press("End");
    assert.equal(await page.locator("#field-effects").inputValue(), "without");
    await page.getByRole("button", { name: "Render", exact: true }).click();
    await page.getByText("Choose at least one effect.").waitFor();
    assert.match(await page.evaluate(() => document.activeElement?.id), /^without-/);
    assert.deepEqual(await label_faults(page), []);
    for (let step = 0; step < 20; step += 1) {
      if ((await page.evaluate(() => document.activeElement?.id)) === "without-diffuse_reflection") break;
      await page.keyboard.press("Tab");
    }
    await page.keyboard.press("Space");
    await page.keyboard.press("Enter");
    await page.waitForURL(/\/jobs\//);
    await state_is(page, "completed");
    await page.locator(".panel .mark", { hasText: "approximation" }).waitFor();
    const of_job = page.locator(".panel .effects-fold");
    assert.match(await of_job.locator("summary").innerText(), /approximation/);
    assert.match(await line(of_job, "diffuse_reflection").innerText(), /left out on request[\s\S]*the picture is another one/);
    assert.match(await page.locator(".stage canvas").getAttribute("aria-label"), /deliberate approximation/);
    await page.getByRole("button", { name: "Render again" }).click();
    assert.equal(await page.locator("#field-effects").inputValue(), "without");
    assert.equal(await page.locator("#without-diffuse_reflection").isChecked(), true);
  })],

  ["the picture appears and is not black", with_tab(async (page, url) => {
    await page.goto(`${url}/jobs/${await done_job(url)}`);
    await picture(page);
    const seen = await until(() => measure(page), (found) => found.lit > 0.5, "the picture stays dark");
    assert.deepEqual([seen.width, seen.height], [160, 120]);
  })],

  ["progress is seen while it renders, and cancel keeps the partial picture", with_tab(async (page) => {
    await begin_job(page, box_files("cancel"), kEndless);
    await state_is(page, "rendering");
    await picture(page);
    const bar = page.locator(".meter progress");
    const before = await bar.evaluate((element) => element.value);
    await until(() => bar.evaluate((element) => element.value), (value) => value > before, "no progress");
    const facts = page.locator(".panel .facts").first();
    await until(() => facts.innerText(), (text) => /rays\/s/.test(text), "no speed");
    const revision = () => page.locator(".stage canvas").evaluate((canvas) => Number(canvas.dataset.revision));
    const first = await revision();
    await until(revision, (value) => value > first, "the picture is not renewed");
    await page.getByRole("button", { name: "Cancel", exact: true }).click();
    await state_is(page, "cancelled");
    assert.equal(await page.getByRole("button", { name: "Cancel", exact: true }).isVisible(), false);
    assert.ok((await until(() => measure(page), (found) => found.lit > 0.1, "no partial picture")).mean > 1);
    await page.reload();
    await state_is(page, "cancelled");
    await picture(page);
  })],

  ["opened late, after completion: everything is there", with_tab(async (page, url) => {
    await page.goto(`${url}/jobs/${await done_job(url)}`);
    await state_is(page, "completed");
    await picture(page);
    const text = await page.locator(".panel").innerText();
    for (const part of ["Elapsed", "Samples", "Speed", "Non-finite samples"]) assert.ok(text.includes(part), part);
    assert.match(await page.title(), /completed/);
  })],

  ["exposure changes the picture and the PNG link", with_tab(async (page, url) => {
    await page.goto(`${url}/jobs/${await done_job(url)}`);
    await picture(page);
    const neutral = await until(() => measure(page), (found) => found.mean > 1, "dark");
    const slider = page.getByLabel("Exposure");
    await slider.focus();
    for (let step = 0; step < 4; step += 1) await page.keyboard.press("]");
    assert.equal(await slider.inputValue(), "2");
    await until(() => measure(page), (found) => found.mean > neutral.mean + 5, "not brighter");
    await slider.fill("-3");
    await until(() => measure(page), (found) => found.mean < neutral.mean - 5, "not darker");
    assert.match(await page.getByRole("link", { name: "PNG" }).getAttribute("href"), /exposure=-3/);
    await page.getByRole("button", { name: "Reset" }).click();
    await until(() => measure(page), (found) => Math.abs(found.mean - neutral.mean) < 0.01 + neutral.mean * 0.02, "not as before");
  })],

  ["a reload keeps the job and its picture", with_tab(async (page, url) => {
    await page.goto(`${url}/jobs/${await done_job(url)}`);
    await picture(page);
    await page.reload();
    await state_is(page, "completed");
    await picture(page);
    await until(() => measure(page), (found) => found.lit > 0.5, "dark after the reload");
  })],

  ["zoom to 100 % and back", with_tab(async (page, url) => {
    await page.goto(`${url}/jobs/${await done_job(url)}`);
    await picture(page);
    await page.getByRole("button", { name: "100 %" }).click();
    await until(() => page.locator(".stage canvas").boundingBox(), (box) => Math.round(box.width) === 160, "not 160 pixels wide");
    await page.keyboard.press("f");
    await until(() => page.locator(".stage canvas").boundingBox(), (box) => box.width > 400, "does not fill the stage");
  })],

  ["the downloads are a PNG and an EXR", with_tab(async (page, url) => {
    await page.goto(`${url}/jobs/${await done_job(url)}`);
    for (const [name, magic] of [["PNG", [0x89, 0x50, 0x4e, 0x47]], ["EXR", [0x76, 0x2f, 0x31, 0x01]]]) {
      const link = page.getByRole("link", { name });
      assert.match(await link.getAttribute("download"), new RegExp(`\\.${name.toLowerCase()}$`));
      const answer = await page.request.get(url + (await link.getAttribute("href")));
      assert.equal(answer.status(), 200);
      assert.deepEqual([...(await answer.body()).subarray(0, 4)], magic);
    }
  })],

  ["the list shows the job with a thumbnail and leads to it", with_tab(async (page, url) => {
    const card = page.locator(`.card[href="/jobs/${await done_job(url)}"]`);
    await card.locator(".chip[data-state=completed]").waitFor();
    await until(() => card.locator("img").evaluate((image) => image.naturalWidth), (width) => width > 0, "no thumbnail");
    await card.click();
    await state_is(page, "completed");
    await page.goBack();
    await card.waitFor();
  })],

  ["render again fills the form with what was asked", with_tab(async (page, url) => {
    await page.goto(`${url}/jobs/${await done_job(url)}`);
    await state_is(page, "completed");
    await page.getByRole("button", { name: "Render again" }).click();
    for (const [key, value] of Object.entries(kSmall)) {
      assert.equal(await page.locator(`#field-${key}`).inputValue(), String(value));
    }
    assert.equal(await page.evaluate(() => document.activeElement?.id), "field-scene");
  })],

  ["layers that were asked for are shown, and asked for again with lens and window", with_tab(async (page, url) => {
    const more = { layers: ["normal", "depth"], lens: { radius: 0.01, focus_distance: 3 }, crop: { x: 2, y: 1, full_width: 200, full_height: 150 } };
    await page.goto(`${url}/jobs/${await render_by_api(url, more)}`);
    await state_is(page, "completed");
    const layers = await page.locator("#layer option").allInnerTexts();
    assert.deepEqual(layers, ["Picture", "Standard error", "Samples", "Seconds", "Normal", "Depth"]);
    await page.locator("#layer").selectOption("normal");
    await page.locator(".legend", { hasText: "red, green, blue" }).waitFor();
    await page.getByRole("button", { name: "Render again" }).click();
    await page.getByText("More settings").click();
    assert.equal(await page.locator("#field-lens").inputValue(), "0.01 3");
    assert.equal(await page.locator("#field-crop").inputValue(), "2 1 200 150");
    for (const [layer, wanted] of [["normal", true], ["depth", true], ["albedo", false]]) {
      assert.equal(await page.getByLabel({ normal: "Normal", depth: "Depth", albedo: "Albedo" }[layer], { exact: true }).isChecked(), wanted);
    }
  })],

  ["less error has a price, and is bought by the keyboard", with_tab(async (page, url) => {
    const id = await done_job(url);
    const known = await (await fetch(`${url}/v1/jobs/${id}`)).json();
    if (!known.accuracy) return; // the mock judges no errors
    await page.goto(`${url}/jobs/${id}`);
    const control = page.getByLabel("Less error");
    await control.waitFor();
    await control.focus();
    const text = page.locator("#price-text");
    for (let step = 0; step < 40; step += 1) await page.keyboard.press("ArrowLeft");
    assert.match(await text.innerText(), /^10 %/);
    const go_on = page.getByRole("button", { name: "Continue to here" });
    for (let step = 0; step < 40 && await go_on.isDisabled(); step += 1) await page.keyboard.press("ArrowRight");
    assert.match(await text.innerText(), /more$/);
    await page.keyboard.press("Tab");
    await page.keyboard.press("Enter");
    await page.waitForURL((to) => /\/jobs\//.test(to.pathname) && !to.pathname.endsWith(id));
    await state_is(page, "completed");
    const next = await (await fetch(`${url}/v1/jobs/${new URL(page.url()).pathname.split("/").pop()}`)).json();
    assert.equal(next.continues.job, id);
    assert.equal(next.done_by, "error");
  })],

  ["a bad upload says what is wrong and where", with_tab(async (page) => {
    await page.setInputFiles("#pick-files", bad_files());
    const reason = page.locator(".upload .problem");
    await reason.waitFor();
    assert.match(await reason.innerText(), /box\.mtl:\d+/);
    await page.getByRole("button", { name: /^Dismiss/ }).click();
    assert.equal(await reason.count(), 0);
  })],

  ["a field that the server refuses has its reason beside it", with_tab(async (page) => {
    await upload(page, box_files("fields"));
    await fill(page, { width: 16384, height: 16384 });
    await page.getByRole("button", { name: "Render", exact: true }).click();
    const reason = page.locator(".field-error:visible, form .problem:visible").first();
    await reason.waitFor();
    assert.ok((await reason.innerText()).length > 5);
    await fill(page, { width: "wide" });
    await page.getByRole("button", { name: "Render", exact: true }).click();
    await page.locator("#field-width-error", { hasText: "whole number" }).waitFor();
    assert.equal(await page.evaluate(() => document.activeElement?.id), "field-width");
  })],

  ["an unknown job has a page that says so", with_tab(async (page) => {
    await page.getByRole("heading", { name: "No such job" }).waitFor();
    await page.getByRole("link", { name: "Back to all jobs" }).click();
    await page.getByRole("heading", { name: "New render" }).waitFor();
  }, "/jobs/j_does_not_exist")],

  ["every control has a name, on both pages and in the help", with_tab(async (page, url) => {
    await upload(page, box_files("labels"));
    await page.getByText("More settings").click();
    await page.selectOption("#field-camera", "own");
    assert.deepEqual(await label_faults(page), []);
    await page.locator("body").press("?");
    await page.getByRole("dialog").waitFor();
    assert.deepEqual(await label_faults(page), []);
    await page.getByRole("button", { name: "Close" }).click();
    await page.getByRole("dialog").waitFor({ state: "hidden" });
    await page.goto(`${url}/jobs/${await done_job(url)}`);
    await state_is(page, "completed");
    await picture(page);
    assert.deepEqual(await label_faults(page), []);
  })],

  ["a narrow screen needs no sideways scrolling", async ({ browser, url }) => {
    for (const path of ["/", `/jobs/${await done_job(url)}`]) {
      const tab = await open_tab(browser, url, path, { width: 360, height: 740 });
      await tab.page.locator(path === "/" ? ".card >> nth=0" : ".stage canvas:not([hidden])").waitFor();
      const overhang = await tab.page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
      assert.ok(overhang <= 0, `${path} is ${overhang} px too wide`);
      await tab.close();
    }
  }],

  ["nothing is loaded from elsewhere", async ({ browser, url }) => {
    const tab = await open_tab(browser, url);
    const addresses = [];
    tab.page.on("request", (request) => addresses.push(request.url()));
    await tab.page.goto(`${url}/jobs/${await done_job(url)}`);
    await picture(tab.page);
    assert.deepEqual(addresses.filter((address) => !address.startsWith(url) && !address.startsWith("blob:")), []);
    await tab.close();
  }],

  ["a batch is found, read and followed to its jobs by keyboard", with_tab(async (page, url) => {
    const done = await (await fetch(`${url}/v1/jobs/${await done_job(url)}`)).json();
    const { samples, ...size } = kSmall;
    const answer = await fetch(`${url}/v1/batches`, {
      method: "POST", headers: { "Content-Type": "application/json" },
      body: JSON.stringify({
        name: "two pictures", defaults: { ...size, stop: { samples } },
        scenes: [{ scene: done.scene, name: "there" }, { scene: "f".repeat(64), name: "gone" }],
      }),
    });
    const { id } = await answer.json();
    await page.keyboard.press("b");
    await until(() => page.evaluate(() => document.activeElement?.textContent), (text) => text === "Batches", "no focus on the list");
    const link = page.locator(".page-batch:visible a", { hasText: "two pictures" });
    await link.first().focus();
    await page.keyboard.press("Enter");
    await until(() => page.title(), (title) => /^failed · two pictures/.test(title), "the batch does not end");
    assert.equal(new URL(page.url()).pathname, `/batches/${id}`);
    const text = await page.locator(".page-batch:visible").innerText();
    assert.match(text, /1 of 2 done, 1 failed/);
    assert.match(text, /there is no such scene/);
    assert.ok(await page.getByRole("button", { name: "Run again what failed" }).isVisible());
    assert.ok(!(await page.getByRole("button", { name: "Cancel the batch" }).isVisible()));
    assert.deepEqual(await label_faults(page), []);
    await page.getByRole("link", { name: "there", exact: true }).focus();
    await page.keyboard.press("Enter");
    // A server may have taken the equal job that is done already.
    await until(() => page.title(), (title) => /^completed · (there|done)/.test(title), "no job behind the link");
  })],

  ["a batch that is not there", with_tab(async (page) => {
    await page.getByRole("heading", { name: "No such batch" }).waitFor();
  }, "/batches/b_none")],
];
