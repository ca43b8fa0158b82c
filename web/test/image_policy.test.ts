import { describe, expect, test } from "vitest";
import { ImagePolicy, pace_ms, type Wanted } from "../src/image_policy";

const at = (revision: number, exposure = 0, job = "j"): Wanted => ({ job, revision, exposure });

describe("ImagePolicy", () => {
  test("asks at once when idle, never twice at a time, newest wins", () => {
    const policy = new ImagePolicy();
    expect(policy.want(at(1))).toEqual(at(1));
    expect(policy.want(at(2))).toBeNull();
    expect(policy.want(at(3))).toBeNull();
    expect(policy.settled(1)).toEqual(at(3));
    expect(policy.settled(3)).toBeNull();
  });

  test("a picture newer than asked for saves the next request", () => {
    const policy = new ImagePolicy();
    policy.want(at(1));
    policy.want(at(2));
    expect(policy.settled(4)).toBeNull();
    expect(policy.want(at(4))).toBeNull();
    expect(policy.want(at(5))).toEqual(at(5));
  });

  test("an older revision is not wanted any more", () => {
    const policy = new ImagePolicy();
    policy.want(at(5));
    policy.settled(5);
    expect(policy.want(at(4))).toBeNull();
  });

  test("another exposure of the same revision is another picture", () => {
    const policy = new ImagePolicy();
    policy.want(at(5));
    policy.settled(5);
    expect(policy.want(at(5, 1))).toEqual(at(5, 1));
    expect(policy.want(at(5, 2))).toBeNull();
    expect(policy.settled(5)).toEqual(at(5, 2));
  });

  test("a failure is not repeated at once, but with the next word of the server", () => {
    const policy = new ImagePolicy();
    policy.want(at(1));
    expect(policy.settled(null)).toBeNull();
    expect(policy.want(at(1))).toEqual(at(1));
  });

  test("a failure still lets a newer wish go ahead", () => {
    const policy = new ImagePolicy();
    policy.want(at(1));
    policy.want(at(2));
    expect(policy.settled(null)).toEqual(at(2));
  });

  test("an answer for another job is not shown", () => {
    const policy = new ImagePolicy();
    const request = policy.want(at(1));
    expect(request && policy.current(request)).toBe(true);
    policy.want(at(1, 0, "other"));
    expect(request && policy.current(request)).toBe(false);
  });

  test("under any order of wishes and answers there is one request and the last wish wins", () => {
    let seed = 7;
    const random = (below: number) => (seed = (seed * 48271) % 2147483647) % below;
    for (let round = 0; round < 200; round += 1) {
      const policy = new ImagePolicy();
      let open: Wanted | null = null;
      let revision = 0;
      let last = at(0);
      let shown: Wanted | null = null;
      for (let step = 0; step < 40; step += 1) {
        if (random(2) === 0) {
          last = at((revision += random(2)), random(3));
          const request = policy.want(last);
          if (request) expect(open).toBeNull();
          open = request ?? open;
        } else if (open) {
          shown = { ...open, revision: Math.max(open.revision, revision - random(2)) };
          open = policy.settled(shown.revision);
        }
      }
      while (open) {
        shown = { ...open };
        open = policy.settled(open.revision);
      }
      if (shown) expect([shown.exposure, shown.revision >= last.revision]).toEqual([last.exposure, true]);
    }
  });
});

test.each([
  ["the first request", 0, Number.POSITIVE_INFINITY, 0], ["small pictures", 10, 50, 150], ["large ones take a fifth of the time", 400, 500, 1500],
  ["huge ones are still renewed", 9000, 9000, 0], ["late enough", 100, 600, 0],
])("pace of %s", (_name, last, since, wait) => expect(pace_ms(last, since)).toBe(wait));
