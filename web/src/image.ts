// Brings the newest picture of a job to the stage. Freshness beyond the policy
// is the browser cache's: answers carry an ETag and "no-cache", so a known
// picture is asked for with If-None-Match and comes back as an empty 304.

import { image_url } from "./api";
import { backoff_ms } from "./backoff";
import type { MapRange } from "./contract";
import { ImagePolicy, pace_ms, type Wanted } from "./image_policy";
import type { Picture } from "./view/picture";

function range_of(headers: Headers): MapRange | null {
  const scale = headers.get("Raykiln-Scale");
  if (scale === null) return null;
  return { low: Number(headers.get("Raykiln-Low")), high: Number(headers.get("Raykiln-High")), scale };
}

export class ImageFeed {
  private policy_ = new ImagePolicy();
  private retry_ = 0;
  private failures_ = 0;
  private held_back_ = 0;
  private begun_ms_ = Number.NEGATIVE_INFINITY;
  private last_ms_ = 0;

  /** Called with what the colours of a map stand for; null for the picture itself. */
  on_range: (range: MapRange | null) => void = () => undefined;

  constructor(private picture_: Picture) {}

  /** `urgent`: asked for by a person, or the last picture of all; anything else is paced. */
  want(wanted: Wanted, urgent: boolean): void {
    clearTimeout(this.held_back_);
    const wait = urgent ? 0 : pace_ms(this.last_ms_, performance.now() - this.begun_ms_);
    if (wait === 0) this.start(this.policy_.want(wanted));
    else this.held_back_ = window.setTimeout(() => this.start(this.policy_.want(wanted)), wait);
  }

  /** The page shows another job now: what is on the stage goes. */
  reset(): void {
    this.policy_ = new ImagePolicy();
    clearTimeout(this.retry_);
    clearTimeout(this.held_back_);
    this.begun_ms_ = Number.NEGATIVE_INFINITY;
    this.picture_.clear();
  }

  private start(request: Wanted | null): void {
    if (request) void this.fetch(request, this.policy_);
  }

  private async fetch(request: Wanted, policy: ImagePolicy): Promise<void> {
    let shown: number | null = null;
    this.begun_ms_ = performance.now();
    const current = (): boolean => policy === this.policy_ && policy.current(request);
    try {
      const answer = await fetch(image_url(request.job, "png", request.exposure, request.revision, request.layer));
      if (answer.ok) {
        const header = answer.headers.get("Raykiln-Revision");
        const revision = header === null ? request.revision : Number(header);
        if (current()) this.on_range(range_of(answer.headers));
        await this.picture_.show(await answer.blob(), revision, request.exposure, current);
        shown = revision;
        this.failures_ = 0;
      }
    } catch {
      // The line is down or the picture was cut; the next event or retry asks again.
    }
    if (policy !== this.policy_) return;
    this.last_ms_ = performance.now() - this.begun_ms_;
    const next = policy.settled(shown);
    this.start(next);
    if (shown === null && next === null) {
      clearTimeout(this.retry_);
      const delay = backoff_ms(2 + this.failures_++, Math.random());
      this.retry_ = window.setTimeout(() => this.want(request, true), delay);
    }
  }
}
