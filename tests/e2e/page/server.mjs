// A real raykilnd on a free port with a store that is thrown away.
import { spawn } from "node:child_process";
import { existsSync, mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";

const kStartMs = 120_000 * Number(process.env.RAYKILN_SLOW ?? 1);

export class Daemon {
  constructor(program, port = 0) {
    this.program = program;
    this.port = port;
    this.folder = mkdtempSync(join(tmpdir(), "raykiln-page-"));
    this.log = "";
  }

  async start() {
    if (!existsSync(this.program)) throw new Error(`${this.program} is not built`);
    const options = ["--listen", `127.0.0.1:${this.port}`, "--store", join(this.folder, "store")];
    this.process = spawn(this.program, options, { stdio: ["ignore", "pipe", "pipe"] });
    this.ended = new Promise((resolve) => this.process.on("exit", resolve));
    const url = await new Promise((resolve, reject) => {
      const timer = setTimeout(() => reject(new Error(`raykilnd is silent:\n${this.log}`)), kStartMs);
      const read = (bytes) => {
        this.log = (this.log + bytes).slice(-20_000);
        const found = /http:\/\/127\.0\.0\.1:(\d+)/.exec(this.log);
        if (!found) return;
        clearTimeout(timer);
        this.port = Number(found[1]);
        resolve(found[0]);
      };
      this.process.stdout.on("data", read);
      this.process.stderr.on("data", read);
      this.process.on("exit", (code) => reject(new Error(`raykilnd ended (${code}):\n${this.log}`)));
    });
    return url;
  }

  async stop() {
    if (this.process && this.process.exitCode === null) {
      this.process.kill("SIGTERM");
      const late = setTimeout(() => this.process.kill("SIGKILL"), kStartMs);
      await this.ended;
      clearTimeout(late);
    }
  }

  discard() {
    rmSync(this.folder, { recursive: true, force: true });
  }
}
