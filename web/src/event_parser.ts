// Parser of the text/event-stream format (HTML standard, 9.2.6), fed with
// chunks cut at arbitrary places. It holds at most one unfinished event, and
// refuses one larger than its bound instead of growing.

export interface ServerEvent {
  /** Value of the `event` field; "message" when absent. */
  name: string;
  /** Last seen `id`; empty before the first. */
  id: string;
  data: string;
}

export const kLargestEventChars = 1 << 20;

export class EventParser {
  private rest_ = "";
  private after_cr_ = false;
  private name_ = "";
  private id_ = "";
  private data_: string[] = [];
  private size_ = 0;
  private first_ = true;
  /** Reconnection delay asked for by the server, in milliseconds. */
  retry_ms: number | null = null;

  /** Returns the events completed by `chunk`. Throws RangeError over the bound. */
  feed(chunk: string): ServerEvent[] {
    const events: ServerEvent[] = [];
    let text = chunk;
    if (this.first_ && text.length > 0) {
      this.first_ = false;
      if (text.charCodeAt(0) === 0xfeff) text = text.slice(1);
    }
    if (this.after_cr_ && text.startsWith("\n")) text = text.slice(1);
    if (text.length > 0) this.after_cr_ = text.endsWith("\r");
    const lines = (this.rest_ + text).split(/\r\n|\r|\n/);
    this.rest_ = lines.pop() ?? "";
    for (const line of lines) this.line(line, events);
    if (this.size_ + this.rest_.length > kLargestEventChars) {
      throw new RangeError("event larger than the bound");
    }
    return events;
  }

  private line(line: string, events: ServerEvent[]): void {
    if (line === "") {
      if (this.data_.length > 0) {
        events.push({ name: this.name_ || "message", id: this.id_, data: this.data_.join("\n") });
      }
      this.name_ = "";
      this.data_ = [];
      this.size_ = 0;
      return;
    }
    const colon = line.indexOf(":");
    if (colon === 0) return; // a comment: the heartbeat
    const field = colon < 0 ? line : line.slice(0, colon);
    const value = colon < 0 ? "" : line.slice(colon + 1).replace(/^ /, "");
    if (field === "data") {
      this.data_.push(value);
      this.size_ += value.length + 1;
    } else if (field === "event") this.name_ = value;
    else if (field === "id" && !value.includes("\0")) this.id_ = value;
    else if (field === "retry" && /^\d+$/.test(value)) this.retry_ms = Number(value);
  }
}
