// Brings the newest picture of a job to the stage. Freshness beyond the policy
// is the browser cache's: answers carry an ETag and "no-cache", so a known
// picture is asked for with If-None-Match and comes back as an empty 304.

import { image_url } from "./api";
import { backoff_ms } from "./backoff";
import { ImagePolicy, type Wanted } from "./image_policy";
import type { Picture } from "./view/picture";

export class ImageFeed {
  private policy_ = new ImagePolicy();
  private retry_ = 0;
  private failures_ = 0;

  constructor(private picture_: Picture) {}

  want(wanted: Wanted): void {
    this.start(this.policy_.want(wanted));
  }

  /** The page shows another job now: what is on the stage goes. */
  reset(): void {
    this.policy_ = new ImagePolicy();
    clearTimeout(this.retry_);
    this.picture_.clear();
  }

  private start(request: Wanted | null): void {
    if (request) void this.fetch(request, this.policy_);
  }

  private async fetch(request: Wanted, policy: ImagePolicy): Promise<void> {
    let shown: number | null = null;
    const current = (): boolean => policy === this.policy_ && policy.current(request);
    try {
      const answer = await fetch(image_url(request.job, "png", request.exposure, request.revision));
      if (answer.ok) {
        const header = answer.headers.get("Raykiln-Revision");
        const revision = header === null ? request.revision : Number(header);
        await this.picture_.show(await answer.blob(), revision, request.exposure, current);
        shown = revision;
        this.failures_ = 0;
      }
    } catch {
      // The line is down or the picture was cut; the next event or retry asks again.
    }
    if (policy !== this.policy_) return;
    const next = policy.settled(shown);
    this.start(next);
    if (shown === null && next === null) {
      clearTimeout(this.retry_);
      const delay = backoff_ms(2 + this.failures_++, Math.random());
      this.retry_ = window.setTimeout(() => this.want(request), delay);
    }
  }
}
