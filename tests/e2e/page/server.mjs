// A real raykilnd on a free port with a store that is thrown away.
import { spawn } from "node:child_process";
import { existsSync, mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";

const kStartMs = 20_000 * Number(process.env.RAYKILN_SLOW ?? 1);

export class Daemon {
  constructor(program, port = 0) {
    this.program = program;
    this.port = port;
    this.folder = mkdtempSync(join(tmpdir(), "raykiln-page-"));
    this.log = "";
  }

  async start() {
    if (!existsSync(this.program)) throw new Error(`${this.program} is not built`);
    const ready = join(this.folder, "ready");
    rmSync(ready, { force: true });
    this.process = spawn(this.program, ["--listen", `127.0.0.1:${this.port}`,
      "--store", join(this.folder, "store"), "--ready-file", ready], { stdio: ["ignore", "pipe", "pipe"] });
    this.ended = new Promise((resolve) => this.process.on("exit", resolve));
    for (const stream of [this.process.stdout, this.process.stderr]) {
      stream.on("data", (bytes) => { this.log = (this.log + bytes).slice(-20_000); });
    }
    return this.ready(ready, Date.now() + kStartMs);
  }

  /** The address, once the daemon has written it. */
  async ready(file, deadline) {
    for (;;) {
      const url = existsSync(file) ? readFileSync(file, "utf8").trim() : "";
      if (url) {
        this.port = Number(new URL(url).port);
        return url;
      }
      if (this.process.exitCode !== null || Date.now() > deadline) {
        throw new Error(`raykilnd is not ready (exit code ${this.process.exitCode}):\n${this.log}`);
      }
      await new Promise((resolve) => setTimeout(resolve, 20));
    }
  }

  async stop() {
    if (this.process && this.process.exitCode === null) {
      this.process.kill("SIGTERM");
      const late = setTimeout(() => this.process.kill("SIGKILL"), 15_000);
      await this.ended;
      clearTimeout(late);
    }
  }

  discard() {
    rmSync(this.folder, { recursive: true, force: true });
  }
}
