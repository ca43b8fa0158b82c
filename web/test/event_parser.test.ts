import { describe, expect, test } from "vitest";
import { EventParser, kLargestEventChars } from "../src/event_parser";

function all(chunks: string[]) {
  const parser = new EventParser();
  return chunks.flatMap((chunk) => parser.feed(chunk));
}

describe("EventParser", () => {
  const stream = "retry: 2000\n\nid: 17\nevent: job\ndata: {\"a\":1}\n\n: heartbeat\n\nid: 18\ndata: x\ndata: y\n\n";
  const expected = [
    { name: "job", id: "17", data: "{\"a\":1}" },
    { name: "message", id: "18", data: "x\ny" },
  ];

  test("reads a whole stream", () => expect(all([stream])).toEqual(expected));

  test("gives the same for every place at which a network may cut", () => {
    for (let at = 0; at <= stream.length; at += 1) {
      expect(all([stream.slice(0, at), stream.slice(at)])).toEqual(expected);
    }
    expect(all([...stream])).toEqual(expected);
  });

  test("takes CR and CRLF line ends, also cut between the two", () => {
    for (const end of ["\r", "\r\n"]) {
      const text = stream.replaceAll("\n", end);
      expect(all([text])).toEqual(expected);
      expect(all([...text])).toEqual(expected);
    }
  });

  test("keeps the retry delay and ignores one that is no number", () => {
    const parser = new EventParser();
    parser.feed("retry: 2000\nretry: soon\n\n");
    expect(parser.retry_ms).toBe(2000);
  });

  test("removes one leading space, and a byte order mark", () => {
    expect(all(["\ufeffdata:  two\n\n"])).toEqual([{ name: "message", id: "", data: " two" }]);
  });

  test("an event without data is not an event", () => expect(all(["event: job\nid: 3\n\n"])).toEqual([]));

  test("an unfinished event is not delivered", () => expect(all(["data: half\n"])).toEqual([]));

  test("refuses to grow without bound", () => {
    const parser = new EventParser();
    const chunk = "data: " + "x".repeat(1 << 16) + "\n";
    expect(() => {
      for (let size = 0; size <= kLargestEventChars + chunk.length; size += chunk.length) parser.feed(chunk);
    }).toThrow(RangeError);
    expect(() => new EventParser().feed("x".repeat(kLargestEventChars + 1))).toThrow(RangeError);
  });
});
