// Which picture to ask for next. At most one request is under way; what is
// wanted meanwhile replaces what was wanted before, so that a slow encoder or
// network shows fewer revisions and never an older one after a newer one.

import type { Layer } from "./contract";

export interface Wanted {
  job: string;
  revision: number;
  exposure: number;
  layer?: Layer;
}

const same_picture = (a: Wanted, b: Wanted): boolean =>
  a.job === b.job && a.exposure === b.exposure && (a.layer ?? "beauty") === (b.layer ?? "beauty");

/** Whether `shown` is as good as `wanted`, or better. */
const covers = (shown: Wanted | null, wanted: Wanted): boolean =>
  shown !== null && same_picture(shown, wanted) && shown.revision >= wanted.revision;

const kShortestPaceMs = 200;
const kLongestPaceMs = 3000;

/**
 * How long to hold back a request for a newer revision. The server encodes each
 * picture that is asked for, on the machine that renders: asking at most a
 * fifth of the time keeps watching cheap for large pictures too.
 * `last_ms`: how long the last request took; `since_ms`: time since it began.
 */
export function pace_ms(last_ms: number, since_ms: number): number {
  const pace = Math.min(kLongestPaceMs, Math.max(kShortestPaceMs, 5 * last_ms));
  return Math.max(0, pace - since_ms);
}

export class ImagePolicy {
  private wanted_: Wanted | null = null;
  private in_flight_: Wanted | null = null;
  private shown_: Wanted | null = null;

  /** Notes what should be on screen; returns the request to start now, if any. */
  want(wanted: Wanted): Wanted | null {
    const last = this.wanted_;
    if (last && same_picture(last, wanted) && wanted.revision < last.revision) return null;
    this.wanted_ = wanted;
    return this.next();
  }

  /**
   * The request under way ended with the picture of `revision` (the server
   * sends the newest it has), or with none: null. Returns the next request.
   */
  settled(revision: number | null): Wanted | null {
    const ended = this.in_flight_;
    this.in_flight_ = null;
    if (ended && revision !== null) this.shown_ = { ...ended, revision };
    if (ended && revision === null && this.wanted_ && covers(ended, this.wanted_)) {
      this.wanted_ = null; // ask again with the next event, not at once
    }
    return this.next();
  }

  /** Whether the answer to `request` may still be put on screen. */
  current(request: Wanted): boolean {
    return request === this.in_flight_ && (this.wanted_ === null || this.wanted_.job === request.job);
  }

  private next(): Wanted | null {
    if (this.in_flight_ || !this.wanted_ || covers(this.shown_, this.wanted_)) return null;
    this.in_flight_ = this.wanted_;
    return this.in_flight_;
  }
}
