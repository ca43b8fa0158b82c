// Cases that a healthy daemon does not produce on demand, against the mock.
import { strict as assert } from "node:assert";
import { begin_job, fill, measure, open_tab, picture, state_is, until, upload } from "./browser.mjs";
import { Mock } from "./mock.mjs";
import { box_files } from "./scene.mjs";

const kSmall = { width: 96, height: 64, samples: 16 };

const with_mock = (body, seconds = 1) => async ({ browser, dist }) => {
  const mock = new Mock(dist, seconds);
  const url = await mock.listen();
  const tab = await open_tab(browser, url);
  try {
    await body(tab.page, mock, url);
    assert.deepEqual(tab.complaints, []);
  } finally {
    await tab.close();
    await mock.close();
  }
};

export const kOddTests = [
  ["a failed job gives reason and remedy, also to those who come late", with_mock(async (page) => {
    await begin_job(page, box_files(), { ...kSmall, name: "fail" });
    const failure = page.locator(".failure");
    await failure.waitFor();
    assert.match(await failure.innerText(), /out of memory while building the tree/);
    assert.match(await failure.innerText(), /Render again/);
    await page.reload();
    await state_is(page, "failed");
    await failure.waitFor();
    assert.match(await page.locator(".waiting").innerText(), /No picture was made/);
  })],

  ["a cut stream is opened again and the end is not missed", with_mock(async (page, mock) => {
    mock.most = 0.5;
    await begin_job(page, box_files(), kSmall);
    await state_is(page, "rendering");
    mock.cut_streams();
    mock.most = 1;
    await state_is(page, "completed");
    assert.equal(await page.locator(".banner").isVisible(), false);
  })],

  ["a server that goes away leaves a banner, and comes back", with_mock(async (page, mock) => {
    await begin_job(page, box_files(), { ...kSmall, name: "slow" });
    await state_is(page, "rendering");
    await picture(page);
    const port = mock.server.address().port;
    await mock.close();
    await page.locator(".banner").waitFor();
    assert.match(await page.locator(".banner").innerText(), /does not answer/);
    assert.ok((await measure(page)).width === 96); // what was known stays
    await mock.listen(port);
    await page.getByRole("button", { name: "Try now" }).click().catch(() => undefined); // it may be back already
    await page.locator(".banner").waitFor({ state: "hidden" });
    await state_is(page, "rendering");
  })],

  ["the list says that the server is away, and recovers", with_mock(async (page, mock) => {
    await page.getByText("Nothing rendered yet").waitFor();
    const port = mock.server.address().port;
    await mock.close();
    await page.locator(".banner").waitFor();
    await mock.listen(port);
    await page.locator(".banner").waitFor({ state: "hidden" });
  })],

  ["no stream to spare: the page polls and still sees the end", with_mock(async (page, mock) => {
    mock.refuse_streams = 100;
    await begin_job(page, box_files(), kSmall);
    await state_is(page, "completed");
    await picture(page);
    assert.equal(await page.locator(".banner").isVisible(), false);
  })],

  ["a full queue is explained, and the second try makes one job", with_mock(async (page, mock) => {
    await upload(page, box_files());
    await fill(page, kSmall);
    mock.busy_submits = 1;
    const render = page.getByRole("button", { name: "Render", exact: true });
    await render.click();
    const problem = page.locator("form .problem");
    await problem.waitFor();
    assert.match(await problem.innerText(), /64 jobs are waiting.*Try again in 3 s/s);
    await render.click();
    await page.waitForURL(/\/jobs\//);
    assert.equal(mock.jobs.size, 1);
  })],

  ["a lost answer to a submission does not make a second job", with_mock(async (page, mock) => {
    await upload(page, box_files());
    await fill(page, kSmall);
    let lose = true;
    await page.route("**/v1/jobs", async (route) => {
      if (route.request().method() !== "POST" || !lose) return route.continue();
      lose = false;
      await route.fetch(); // the server gets it, the page never hears
      await route.abort();
    });
    const render = page.getByRole("button", { name: "Render", exact: true });
    await render.click();
    await page.locator("form .problem").waitFor();
    await render.click();
    await page.waitForURL(/\/jobs\//);
    assert.equal(mock.jobs.size, 1);
  })],

  ["slow pictures: one request at a time, and the last one is the final one", with_mock(async (page, mock) => {
    mock.image_delay_ms = 350;
    await begin_job(page, box_files(), kSmall);
    await state_is(page, "completed");
    const job = [...mock.jobs.values()][0];
    await until(() => page.locator(".stage canvas").evaluate((canvas) => Number(canvas.dataset.revision)),
      (revision) => revision === job.image.revision, "the final picture is missing");
    assert.equal(mock.image_requests.most, 1);
    assert.ok(mock.image_requests.total < 12, `${mock.image_requests.total} requests`);
  }, 2)],

  ["a dragged slider asks for few pictures and ends at its place", with_mock(async (page, mock) => {
    await begin_job(page, box_files(), kSmall);
    await state_is(page, "completed");
    await picture(page);
    const before = mock.image_requests.total;
    const begun = performance.now();
    await page.getByLabel("Exposure").focus();
    for (let step = 0; step < 30; step += 1) await page.keyboard.press("ArrowRight");
    await until(() => page.locator(".stage canvas").evaluate((canvas) => canvas.dataset.exposure), (value) => value === "3", "not at 3 EV");
    // One whenever the slider has rested for 120 ms, which it may do where a key takes as long.
    const asked = mock.image_requests.total - before;
    const seconds = (performance.now() - begun) / 1000;
    assert.ok(asked <= 3 + seconds / 0.12, `${asked} requests in ${seconds} s`);
  })],

  ["a folder's files keep their paths", with_mock(async (page, mock) => {
    const [obj, mtl] = box_files();
    const chooser = page.waitForEvent("filechooser");
    await page.getByRole("button", { name: "or a folder" }).click();
    const { mkdtempSync, mkdirSync, rmSync, writeFileSync } = await import("node:fs");
    const { join } = await import("node:path");
    const folder = mkdtempSync(join((await import("node:os")).tmpdir(), "raykiln-folder-"));
    mkdirSync(join(folder, "materials"));
    writeFileSync(join(folder, "box.obj"), obj.buffer);
    writeFileSync(join(folder, "materials", "box.mtl"), mtl.buffer);
    await (await chooser).setFiles(folder);
    await page.locator(".upload-status", { hasText: "ready" }).waitFor();
    assert.deepEqual([...mock.scenes.values()][0].files, ["box.obj", "materials/box.mtl"]);
    rmSync(folder, { recursive: true });
  })],

  ["the list goes on to older jobs", with_mock(async (page, mock) => {
    for (let index = 0; index < 60; index += 1) {
      const job = mock.add_job({ scene: "0".repeat(64), name: `job ${index}`, width: 8, height: 8, stop: { samples: 1 } });
      job.created_at = new Date(1.7e12 + index * 1000).toISOString();
      mock.finish(job, "cancelled");
    }
    await page.reload();
    await until(() => page.locator(".card").count(), (count) => count === 50, "not one page of jobs");
    assert.match(await page.locator(".card-title").first().innerText(), /job 59/);
    await page.getByRole("button", { name: "Show older jobs" }).click();
    await until(() => page.locator(".card").count(), (count) => count === 60, "no older jobs");
    assert.equal(await page.getByRole("button", { name: "Show older jobs" }).isVisible(), false);
    assert.match(await page.locator(".card-title").last().innerText(), /job 0/);
  })],

  ["progress is spoken in quarters, not in every step", with_mock(async (page, mock) => {
    await page.evaluate(() => {
      window.spoken = [];
      const voice = document.querySelector("[aria-live=polite]");
      new MutationObserver(() => window.spoken.push(voice.textContent)).observe(voice, { childList: true, characterData: true, subtree: true });
    });
    mock.most = 0;
    await begin_job(page, box_files(), kSmall);
    await state_is(page, "rendering");
    for (let step = 1; step <= 20; step += 1) {
      mock.most = step / 20;
      const seen = () => page.locator(".meter progress").evaluate((bar) => bar.value / bar.max);
      if (step < 20) await until(seen, (value) => value > (step - 0.5) / 20, "the bar does not move");
    }
    await state_is(page, "completed");
    const spoken = await page.evaluate(() => window.spoken);
    assert.match(spoken.at(-1), /^Render completed in/);
    assert.ok(spoken.some((text) => /% rendered/.test(text)), spoken.join(" | "));
    assert.ok(spoken.length <= 9, spoken.join(" | "));
  }, 0.1)],
];
