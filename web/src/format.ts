// Figures as people read them. Every function is pure and total: what is
// unknown (null, NaN) becomes an en dash, never "NaN" or an empty cell.

export const kUnknown = "–";

const known = (value: number | null | undefined): value is number =>
  typeof value === "number" && Number.isFinite(value);

/** Three significant digits without an exponent: 0.0123, 4.56, 78.9, 1230. */
function significant(value: number): string {
  const magnitude = Math.abs(Number(value.toPrecision(3))); // 0.9999 is shown as 1.00
  const decimals = magnitude >= 100 ? 0 : magnitude >= 10 ? 1 : magnitude >= 1 ? 2 : 3;
  return value.toFixed(decimals);
}

/** Seconds as "0.4 s", "12 s", "3 min 05 s", "2 h 07 min". */
export function duration(seconds: number | null | undefined): string {
  if (!known(seconds) || seconds < 0) return kUnknown;
  if (seconds < 9.95) return `${seconds.toFixed(1)} s`;
  const whole = Math.round(seconds);
  if (whole < 60) return `${whole} s`;
  if (whole < 3600) return `${Math.floor(whole / 60)} min ${pad(whole % 60)} s`;
  const minutes = Math.round(seconds / 60);
  return `${Math.floor(minutes / 60)} h ${pad(minutes % 60)} min`;
}

const pad = (value: number): string => String(value).padStart(2, "0");

/** A whole number with thin spaces between groups of three: 1 234 567. */
export function count(value: number | null | undefined): string {
  if (!known(value)) return kUnknown;
  return String(Math.round(value)).replace(/\B(?=(\d{3})+(?!\d))/g, "\u2009");
}

/** A number with an SI prefix, "1.23 M". */
export function si(value: number | null | undefined): string {
  if (!known(value)) return kUnknown;
  const steps: [number, string][] = [[1e12, "T"], [1e9, "G"], [1e6, "M"], [1e3, "k"]];
  for (const [factor, prefix] of steps) {
    if (Math.abs(value) >= factor * 0.9995) return `${significant(value / factor)} ${prefix}`;
  }
  return Number.isInteger(value) ? String(value) : significant(value);
}

/** Rays per second as "1.23 Mrays/s". */
export function ray_rate(rays_per_second: number | null | undefined): string {
  if (!known(rays_per_second)) return kUnknown;
  const text = si(rays_per_second);
  return /\D$/.test(text) ? `${text}rays/s` : `${text} rays/s`;
}

/** Bytes with binary prefixes, "1.5 MiB". */
export function bytes(value: number | null | undefined): string {
  if (!known(value)) return kUnknown;
  const units = ["B", "KiB", "MiB", "GiB", "TiB"];
  let scaled = value;
  let unit = 0;
  while (Math.abs(scaled) >= 1023.5 && unit < units.length - 1) {
    scaled /= 1024;
    unit += 1;
  }
  return `${unit === 0 ? String(Math.round(scaled)) : significant(scaled)} ${units[unit]}`;
}

/** A fraction 0..1 as a whole percentage; 100 % only when it is really done. */
export function percent(fraction: number | null | undefined): string {
  if (!known(fraction)) return kUnknown;
  if (fraction >= 1) return "100 %";
  return `${Math.min(99, Math.max(0, Math.floor(fraction * 100)))} %`;
}

/** An exposure in stops with its sign: "+1.5 EV". */
export function stops(ev: number): string {
  const sign = ev > 0 ? "+" : ev < 0 ? "−" : "±";
  return `${sign}${Math.abs(ev).toFixed(1)} EV`;
}

/** A moment relative to now: "just now", "5 min ago", "yesterday". */
export function ago(iso: string | null | undefined, now_ms: number): string {
  const then = iso ? Date.parse(iso) : Number.NaN;
  if (Number.isNaN(then)) return kUnknown;
  const seconds = Math.max(0, (now_ms - then) / 1000);
  if (seconds < 45) return "just now";
  if (seconds < 3600) return `${Math.max(1, Math.round(seconds / 60))} min ago`;
  if (seconds < 86400) return `${Math.round(seconds / 3600)} h ago`;
  const days = Math.round(seconds / 86400);
  return days === 1 ? "yesterday" : `${days} days ago`;
}

/** "merge_seconds" -> "Merge time": the key's last word is its unit, which the value shows. */
export function label_of(key: string): string {
  const words = key
    .replace(/_seconds$/, "_time").replace(/_bytes$/, "_memory").replace(/_(fraction|total)$/, "")
    .replace(/^non_/, "non-").replaceAll("_", " ");
  return words.charAt(0).toUpperCase() + words.slice(1);
}

/** A statistic's value; the unit comes from the key's last word. */
export function statistic(key: string, value: unknown): string {
  if (value === null || value === undefined) return kUnknown;
  if (typeof value === "boolean") return value ? "yes" : "no";
  if (typeof value !== "number") return String(value);
  if (key.endsWith("rays_per_second")) return ray_rate(value);
  if (key.endsWith("_per_second")) return `${si(value)}/s`;
  if (key === "seconds" || key.endsWith("_seconds")) return precise_seconds(value);
  if (key === "bytes" || key.endsWith("_bytes")) return bytes(value);
  if (/(fraction|overhead|occupancy)$/.test(key)) return `${(value * 100).toFixed(2)} %`;
  return Number.isInteger(value) ? count(value) : String(Number(value.toPrecision(4)));
}

function precise_seconds(seconds: number): string {
  if (seconds !== 0 && Math.abs(seconds) < 1) return `${significant(seconds * 1000)} ms`;
  return seconds < 60 ? `${significant(seconds)} s` : duration(seconds);
}

/** An error as a share: "1.9 %", with two digits that count. */
export const error_percent = (share: number): string => `${Number((100 * share).toPrecision(2))} %`;
