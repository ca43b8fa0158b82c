// A stand-in for the daemon that speaks proto/openapi.yaml as far as the page
// uses it. Time is driven by its own clock; odd cases are asked for by name:
// the job's `name` may hold "fail" or "slow" (it never ends by itself); other faults are set through the object.
import { createHash, randomBytes } from "node:crypto";
import { createReadStream, existsSync } from "node:fs";
import { createServer } from "node:http";
import { extname, join, normalize } from "node:path";
import { until } from "./browser.mjs";
import { encode_png, radiance } from "./png.mjs";

const kTypes = { ".html": "text/html; charset=utf-8", ".js": "text/javascript", ".css": "text/css", ".svg": "image/svg+xml" };
const is_final = (job) => ["completed", "failed", "cancelled"].includes(job.state);
/** What every scene of the mock calls for, less what is left out; a part of the daemon's list. */
function effects_of(choice) {
  const without = choice?.without ?? [];
  const rows = [["point_lights", "1 point light with power above 0"], ["diffuse_reflection", "material `red`: diffuse 0.8 0.1 0.1"],
    ["refraction", ""]];
  const list = rows.map(([effect, evidence]) => {
    const called_for = evidence !== "";
    const simulated = choice === "all" || (called_for && !without.includes(effect));
    return { effect, called_for, simulated, evidence: evidence || "no specular material in use is transparent",
      grade: simulated ? "" : called_for ? "bounded" : "identical", left_out: simulated ? "" : `the code of ${effect}` };
  });
  const approximation = list.some((line) => line.called_for && !line.simulated);
  return { label: without.length ? `without=${without.join(",")}` : choice ?? "auto", approximation, list };
}
const now = () => new Date().toISOString();

export class Mock {
  /** `dist`: folder of the built page; `seconds`: how long a job renders. */
  constructor(dist, seconds = 1.5) {
    this.dist = dist;
    this.seconds = seconds;
    this.scenes = new Map();
    this.jobs = new Map();
    this.batches = new Map();
    this.keys = new Map();
    this.watchers = new Map();
    this.frames = new Map();
    this.image_requests = { now: 0, most: 0, total: 0 };
    this.refuse_streams = 0; // next n event streams answer 503
    this.busy_submits = 0; // next n submissions answer 429
    this.image_delay_ms = 0;
    this.most = 1; // no job gets further: what a test wants to see does not pass while it looks elsewhere
    this.streams = new Set();
    this.server = createServer((request, answer) => void this.route(request, answer).catch((error) => {
      this.problem(answer, 500, "internal", String(error));
    }));
  }

  async listen(port = 0) {
    await until(() => this.bind(port), (bound) => bound, `port ${port} stays taken`);
    this.timer = setInterval(() => this.tick(), 60);
    return `http://127.0.0.1:${this.server.address().port}`;
  }

  /** False while the port is taken: a client that tries to reach it may have got it as its own. */
  bind(port) {
    return new Promise((resolve, reject) => {
      const failed = (error) => (error.code === "EADDRINUSE" ? resolve(false) : reject(error));
      this.server.once("error", failed);
      this.server.listen(port, "127.0.0.1", () => {
        this.server.off("error", failed);
        resolve(true);
      });
    });
  }

  async close() {
    clearInterval(this.timer);
    this.server.closeAllConnections();
    await new Promise((resolve) => this.server.close(resolve));
  }

  cut_streams() {
    for (const stream of this.streams) stream.destroy();
  }

  json(answer, status, value, headers = {}) {
    const body = JSON.stringify(value);
    answer.writeHead(status, { "Content-Type": status >= 400 ? "application/problem+json" : "application/json", ...headers });
    answer.end(body);
  }

  problem(answer, status, code, detail, more = {}, headers = {}) {
    this.json(answer, status, { type: `about:blank#${code}`, title: code.replaceAll("_", " "), status, code, detail, ...more }, headers);
  }

  async route(request, answer) {
    const url = new URL(request.url, "http://mock");
    const parts = url.pathname.split("/").filter(Boolean);
    const method = request.method;
    if (parts[0] !== "v1") return this.page(url.pathname, answer);
    if (parts[1] === "scenes" && parts.length === 2) {
      if (method === "POST") return this.upload(request, url, answer);
      return this.json(answer, 200, { scenes: [...this.scenes.values()].reverse(), next_cursor: null });
    }
    if (parts[1] === "scenes") {
      const scene = this.scenes.get(parts[2]);
      return scene ? this.json(answer, 200, scene) : this.problem(answer, 404, "scene_not_found", "no such scene");
    }
    if (parts[1] === "jobs" && parts.length === 2) {
      if (method === "POST") return this.submit(request, answer);
      const all = [...this.jobs.values()].reverse();
      const from = Number(url.searchParams.get("cursor") ?? 0);
      return this.json(answer, 200, { jobs: all.slice(from, from + 50), next_cursor: all.length > from + 50 ? String(from + 50) : null });
    }
    if (parts[1] === "batches") return this.batch(method, parts.slice(2), request, answer);
    const job = this.jobs.get(parts[2]);
    if (!job) return this.problem(answer, 404, "job_not_found", "no such job");
    if (parts.length === 3) return this.json(answer, 200, job);
    if (parts[3] === "cancel") return this.cancel(job, answer);
    if (parts[3] === "events") return this.events(job, request, answer);
    if (parts[3] === "image") return this.image(job, url, request, answer);
    return this.problem(answer, 404, "not_found", "no such path");
  }

  page(path, answer) {
    const name = path === "/" || path.startsWith("/jobs/") || path.startsWith("/batches") ? "index.html" : normalize(path).slice(1);
    const file = join(this.dist, name);
    if (!kTypes[extname(name)] || !existsSync(file)) return this.problem(answer, 404, "not_found", "no such file");
    answer.writeHead(200, { "Content-Type": kTypes[extname(name)],
      "Content-Security-Policy": "default-src 'self'; script-src 'self'; style-src 'self'; img-src 'self' blob:" });
    createReadStream(file).pipe(answer);
  }

  async body(request) {
    const chunks = [];
    for await (const chunk of request) chunks.push(chunk);
    return Buffer.concat(chunks);
  }

  async upload(request, url, answer) {
    const body = await this.body(request);
    const text = body.toString("latin1");
    const names = [...text.matchAll(/filename="([^"]*)"/g)].map((match) => match[1]);
    if (text.includes("Kd oops")) {
      return this.problem(answer, 422, "scene_invalid", "Kd needs three numbers", { where: "box.mtl:7" });
    }
    const id = createHash("sha256").update(body).digest("hex");
    const known = this.scenes.has(id);
    const scene = this.scenes.get(id) ?? {
      id, name: url.searchParams.get("name") ?? "", kind: names.length ? "files" : "zip", bytes: body.length, files: names,
      created_at: now(), triangles: 18432, dropped_triangles: 3, materials: 7, lights: { point: 1, emitting_triangles: 2 },
      cameras: [{ index: 0, name: "front" }, { index: 1, name: "from above" }],
      effects: effects_of("auto"),
      bounds: { min: [-1, -1, -1], max: [1, 1, 1] }, tree: null, cache: "absent",
      warnings: [{ code: "ignored_texture", message: "textures of this kind are not supported yet: 'bump' is ignored, factors are used", where: "box.mtl:12", count: 3 }],
    };
    this.scenes.set(id, scene);
    this.json(answer, known ? 200 : 201, scene, { Location: `/v1/scenes/${id}` });
  }

  async submit(request, answer) {
    const body = JSON.parse((await this.body(request)).toString());
    if (this.busy_submits > 0) {
      this.busy_submits -= 1;
      return this.problem(answer, 429, "queue_full", "64 jobs are waiting", {}, { "Retry-After": "3" });
    }
    const key = request.headers["idempotency-key"];
    if (key && this.keys.has(key)) return this.json(answer, 202, this.jobs.get(this.keys.get(key)));
    const errors = [];
    if (body.width * body.height > 3e7) errors.push({ pointer: "/width", code: "out_of_range", detail: "the film would not fit into memory" });
    if (body.stop.samples > 1048576) errors.push({ pointer: "/stop/samples", code: "out_of_range", detail: "must be an integer from 1 to 1048576" });
    if (errors.length) return this.problem(answer, 422, "invalid_request", `${errors.length} fields are wrong`, { errors });
    const job = this.add_job(body);
    if (key) this.keys.set(key, job.id);
    this.json(answer, 202, job, { Location: `/v1/jobs/${job.id}` });
  }

  add_job(request) {
    const tiles = Math.ceil(request.width / (request.tile ?? 64)) * Math.ceil(request.height / (request.tile ?? 64));
    const job = {
      id: `j_${randomBytes(8).toString("hex")}`, scene: request.scene, name: request.name ?? "", state: "queued", revision: 1,
      created_at: now(), started_at: null, finished_at: null, request, queue_position: 0, prepare: null,
      progress: { fraction: 0, samples_done: 0, samples_target: request.stop.samples, tiles_started: 0, tiles_done: 0, tiles_total: tiles },
      elapsed_seconds: 0, remaining_seconds: null,
      statistics: { rays: 0, rays_per_second: 0, non_finite_samples: 0 }, effects: null, warnings: [], error: null, image: null,
    };
    this.jobs.set(job.id, job);
    return job;
  }

  /** No more than one picture a scene; items of unknown scenes fail. */
  async batch(method, [id, what], request, answer) {
    if (method === "POST" && !id) {
      const body = JSON.parse((await this.body(request)).toString());
      const items = body.scenes.map(({ scene, name }) => this.scenes.has(scene)
        ? { name, scene, job: this.add_job({ scene, name, ...body.defaults }).id, error: null }
        : { name, scene, job: null, error: { title: "Not found", status: 404, code: "scene_not_found", detail: "there is no such scene" } });
      const made = { id: `b_${randomBytes(8).toString("hex")}`, name: body.name ?? "", created_at: now(), items };
      this.batches.set(made.id, made);
      return this.json(answer, 202, this.batch_view(made));
    }
    if (!id) return this.json(answer, 200, { batches: [...this.batches.values()].reverse().map((b) => this.batch_view(b)), next_cursor: null });
    const batch = this.batches.get(id);
    if (!batch) return this.problem(answer, 404, "batch_not_found", "there is no such batch");
    return this.json(answer, what ? 202 : 200, this.batch_view(batch));
  }

  batch_view(batch) {
    const items = batch.items.map((item) => {
      const job = item.job && this.jobs.get(item.job);
      return { ...item, reused: false, attempt: 1, state: item.error ? "failed" : is_final(job) ? job.state : "active" };
    });
    const of = (state) => items.filter((item) => item.state === state).length;
    const counts = { waiting: 0, active: of("active"), completed: of("completed"), failed: of("failed"), cancelled: of("cancelled"), skipped: 0, reused: 0, total: items.length };
    const state = counts.active ? "running" : counts.failed ? "failed" : counts.cancelled ? "cancelled" : "completed";
    return { ...batch, items, counts, state, revision: Date.now(), finished_at: counts.active ? null : now() };
  }

  change(job, changes) {
    Object.assign(job, changes);
    job.revision += 1;
    for (const send of this.watchers.get(job.id) ?? []) send();
  }

  finish(job, state, more = {}) {
    this.change(job, { state, finished_at: now(), remaining_seconds: null, prepare: null, queue_position: null, ...more });
  }

  cancel(job, answer) {
    if (["completed", "failed"].includes(job.state)) {
      return this.problem(answer, 409, "job_finished", "the job has finished");
    }
    if (!is_final(job)) {
      this.change(job, { state: "cancelling" });
      setTimeout(() => this.finish(job, "cancelled"), 150);
    }
    this.json(answer, 202, job);
  }

  tick() {
    for (const job of this.jobs.values()) {
      const age = (Date.now() - Date.parse(job.created_at)) / 1000;
      if (job.state === "queued" && age > 0.15) {
        this.change(job, { state: "preparing", queue_position: null, started_at: now(), prepare: { stage: "building", fraction: 0.4 } });
      } else if (job.state === "preparing" && age > 0.35) {
        if (job.name.includes("fail")) {
          this.finish(job, "failed", { error: { type: "about:blank#render_failed", title: "Rendering failed", status: 500, code: "render_failed", detail: "out of memory while building the tree" } });
        } else this.change(job, { state: "rendering", prepare: null, effects: effects_of(job.request.effects) });
      } else if (job.state === "rendering") this.advance(job);
    }
  }

  advance(job) {
    const endless = job.name.includes("slow") || job.progress.samples_target > 10000;
    const elapsed = (Date.now() - Date.parse(job.started_at)) / 1000;
    const seconds = endless ? 30 : this.seconds;
    const fraction = Math.min(this.most, endless ? 1 - Math.exp(-elapsed / seconds) : (elapsed - 0.2) / seconds);
    const { samples_target, tiles_total } = job.progress;
    const rays = Math.round(fraction * samples_target * job.request.width * job.request.height * 6.4);
    const first = Math.min(1, fraction * 8);
    const changes = {
      progress: { fraction, samples_done: fraction * samples_target, samples_target, tiles_started: Math.floor(first * tiles_total),
        tiles_done: Math.floor(Math.max(0, fraction * 4 - 3) * tiles_total), tiles_total },
      elapsed_seconds: elapsed, remaining_seconds: Math.max(0, seconds - elapsed),
      statistics: { rays, camera_rays: Math.round(rays / 4), bounce_rays: Math.round(rays / 4), shadow_rays: Math.round(rays / 2), paths: Math.round(rays / 4),
        rays_per_second: rays / Math.max(0.01, elapsed), non_finite_samples: 0, negative_samples: 0, truncated_paths: 12, roulette_ends: 0, lights_at_hits: 0, stream_calls: 0, short_stream_calls: 0, bad_samples: [],
        tree_build_seconds: 0.084, prepare_seconds: 0.091, render_seconds: elapsed, worker_seconds: elapsed * 1.97, idle_seconds: 0.013,
        merge_seconds: 0.021, publish_seconds: 0.009, overhead_fraction: 0.0113, tasks: 118, retried_tasks: 0, film_bytes: 90112000 },
      image: { revision: job.revision + 1, png: "", exr: "" },
    };
    if (fraction < 1) return this.change(job, changes);
    this.finish(job, "completed", { ...changes, elapsed_seconds: elapsed });
    const scene = this.scenes.get(job.scene);
    if (scene) scene.tree = { build_seconds: 0.084, nodes: 40211, leaves: 20106, references: 61204, sah_cost: 24.8, bytes: 2301224, depth: 21 };
  }

  events(job, request, answer) {
    if (this.refuse_streams > 0) {
      this.refuse_streams -= 1;
      return this.problem(answer, 503, "too_many_streams", "too many event streams", {}, { "Retry-After": "1" });
    }
    if (is_final(job) && request.headers["last-event-id"] === String(job.revision)) return answer.writeHead(204).end();
    answer.writeHead(200, { "Content-Type": "text/event-stream", "Cache-Control": "no-store" });
    answer.write("retry: 2000\n\n");
    this.streams.add(request.socket);
    let last = 0;
    const send = () => {
      if (job.revision === last || answer.writableEnded) return;
      if (!is_final(job) && Date.now() - sent_at < 100) return;
      last = job.revision;
      sent_at = Date.now();
      const text = `id: ${job.revision}\nevent: job\ndata: ${JSON.stringify(job)}\n\n`;
      answer.write(text.slice(0, 20)); // cut inside a line, as networks do
      answer.write(text.slice(20));
      if (is_final(job)) answer.end();
    };
    let sent_at = 0;
    const all = this.watchers.get(job.id) ?? new Set();
    this.watchers.set(job.id, all.add(send));
    const beat = setInterval(() => answer.write(": heartbeat\n\n"), 1000);
    answer.on("close", () => { clearInterval(beat); all.delete(send); this.streams.delete(request.socket); });
    send();
  }

  async image(job, url, request, answer) {
    if (!job.image) return this.problem(answer, 404, "image_not_ready", "no picture yet", {}, { "Retry-After": "1" });
    const exposure = Number(url.searchParams.get("exposure") ?? 0);
    const counts = this.image_requests;
    counts.now += 1;
    counts.total += 1;
    counts.most = Math.max(counts.most, counts.now);
    if (this.image_delay_ms) await new Promise((resolve) => setTimeout(resolve, this.image_delay_ms));
    counts.now -= 1;
    const revision = job.image.revision;
    const etag = `"${revision}-${url.searchParams.get("format")}-${exposure}"`;
    const headers = { ETag: etag, "Cache-Control": "no-cache", "Raykiln-Revision": String(revision) };
    if (request.headers["if-none-match"] === etag) return answer.writeHead(304, headers).end();
    if (url.searchParams.get("format") === "exr") {
      answer.writeHead(200, { ...headers, "Content-Type": "image/x-exr" });
      return answer.end(Buffer.from([0x76, 0x2f, 0x31, 0x01]));
    }
    answer.writeHead(200, { ...headers, "Content-Type": "image/png" });
    answer.end(this.draw(job, exposure));
  }

  frame(width, height) {
    const key = `${width}x${height}`;
    let frame = this.frames.get(key);
    if (!frame) {
      frame = new Float32Array(width * height * 3);
      for (let y = 0; y < height; y += 1) {
        for (let x = 0; x < width; x += 1) {
          frame.set(radiance((x + 0.5) / width, (y + 0.5) / height, width / height), (y * width + x) * 3);
        }
      }
      this.frames.set(key, frame);
    }
    return frame;
  }

  draw(job, exposure) {
    const { width, height, tile = 64 } = job.request;
    const frame = this.frame(width, height);
    const columns = Math.ceil(width / tile);
    const noise = 0.55 / Math.sqrt(Math.max(1, job.progress.samples_done));
    const rgb = Buffer.alloc(width * height * 3);
    const gain = 2 ** exposure;
    for (let y = 0; y < height; y += 1) {
      for (let x = 0; x < width; x += 1) {
        if (Math.floor(y / tile) * columns + Math.floor(x / tile) >= job.progress.tiles_started) continue;
        const at = (y * width + x) * 3;
        for (let k = 0; k < 3; k += 1) {
          const linear = Math.max(0, frame[at + k] * (1 + noise * (Math.random() * 4 - 2))) * gain;
          const curve = linear <= 0.0031308 ? 12.92 * linear : 1.055 * linear ** (1 / 2.4) - 0.055;
          rgb[at + k] = Math.max(0, Math.min(255, Math.round(curve * 255)));
        }
      }
    }
    return encode_png(width, height, rgb);
  }
}
