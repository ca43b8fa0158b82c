// The smallest PNG writer and a picture worth looking at, for the mock server.
import { deflateSync } from "node:zlib";

const crc = table_crc(); // zlib.crc32 is newer than node 18

function table_crc() {
  const table = new Uint32Array(256).map((_, index) => {
    let value = index;
    for (let bit = 0; bit < 8; bit += 1) value = value & 1 ? 0xedb88320 ^ (value >>> 1) : value >>> 1;
    return value;
  });
  return (bytes) => {
    let value = 0xffffffff;
    for (const byte of bytes) value = table[(value ^ byte) & 255] ^ (value >>> 8);
    return (value ^ 0xffffffff) >>> 0;
  };
}

function chunk(type, body) {
  const data = Buffer.concat([Buffer.from(type, "latin1"), body]);
  const out = Buffer.alloc(data.length + 8);
  out.writeUInt32BE(body.length, 0);
  data.copy(out, 4);
  out.writeUInt32BE(crc(data), data.length + 4);
  return out;
}

/** rgb: 8-bit triples, rows from the top. */
export function encode_png(width, height, rgb) {
  const head = Buffer.alloc(13);
  head.writeUInt32BE(width, 0);
  head.writeUInt32BE(height, 4);
  head.set([8, 2, 0, 0, 0], 8);
  const rows = Buffer.alloc((width * 3 + 1) * height);
  for (let y = 0; y < height; y += 1) {
    rgb.copy(rows, y * (width * 3 + 1) + 1, y * width * 3, (y + 1) * width * 3);
  }
  return Buffer.concat([
    Buffer.from([137, 80, 78, 71, 13, 10, 26, 10]),
    chunk("IHDR", head), chunk("IDAT", deflateSync(rows, { level: 1 })), chunk("IEND", Buffer.alloc(0)),
  ]);
}

/** Linear radiance of a box with two spheres: a stand-in, lit by formula, not by a renderer. */
export function radiance(u, v, aspect) {
  const height = Math.min(0.86, 0.93 / aspect); // the room fills wide pictures too
  const direction = unit([(u - 0.5) * aspect * height, (0.5 - v) * height, -1]);
  return shade([0, 0, 3.1], direction, 0);
}

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const along = (a, t, b) => [a[0] + t * b[0], a[1] + t * b[1], a[2] + t * b[2]];
const unit = (a) => { const l = Math.sqrt(dot(a, a)); return [a[0] / l, a[1] / l, a[2] / l]; };
const kSpheres = [{ c: [-0.45, -0.62, -0.35], r: 0.38, mirror: true }, { c: [0.45, -0.65, 0.25], r: 0.35, mirror: false }];

function sphere_t(o, d, s) {
  const oc = along(o, -1, s.c);
  const b = dot(oc, d);
  const q = b * b - dot(oc, oc) + s.r * s.r;
  if (q < 0) return Infinity;
  const t = -b - Math.sqrt(q);
  return t > 1e-3 ? t : Infinity;
}

function shade(o, d, depth) {
  let t = Infinity, n = null, albedo = null, mirror = false;
  const walls = [[0, -1, [0.62, 0.1, 0.08]], [0, 1, [0.12, 0.42, 0.13]], [1, -1, [0.7, 0.68, 0.64]], [1, 1, [0.7, 0.68, 0.64]], [2, -1, [0.7, 0.68, 0.64]]];
  for (const [axis, side, colour] of walls) {
    const tw = (side - o[axis]) / d[axis];
    if (!(tw > 1e-3 && tw < t)) continue;
    const p = along(o, tw, d);
    if ([0, 1, 2].some((k) => k !== axis && (Math.abs(p[k]) > 1.0001 && !(k === 2 && p[k] > -1)))) continue;
    if (p[2] > 1.0001) continue;
    t = tw; n = [0, 0, 0]; n[axis] = -side; albedo = colour;
  }
  for (const s of kSpheres) {
    const ts = sphere_t(o, d, s);
    if (ts < t) { t = ts; n = unit(along(along(o, ts, d), -1, s.c)); albedo = [0.8, 0.78, 0.74]; mirror = s.mirror; }
  }
  if (t === Infinity) return [0, 0, 0];
  const p = along(o, t, d);
  if (n[1] < -0.5 && Math.abs(p[0]) < 0.34 && Math.abs(p[2]) < 0.34) return [9, 8.2, 6.6];
  if (mirror && depth < 2) return shade(p, along(d, -2 * dot(d, n), n), depth + 1).map((x) => x * 0.9);
  let light = 0;
  for (let k = 0; k < 16; k += 1) {
    const l = [((k % 4) - 1.5) * 0.17, 0.999, (Math.floor(k / 4) - 1.5) * 0.17];
    const to = along(l, -1, p);
    const d2 = dot(to, to);
    const w = unit(to);
    if (kSpheres.some((s) => sphere_t(p, w, s) < Math.sqrt(d2) - 1e-3)) continue;
    light += Math.max(0, dot(n, w)) * Math.max(0, w[1]) / (d2 + 0.1) / 16;
  }
  const bounce = 0.11 + 0.05 * n[1] + 0.04 * (1 - Math.abs(p[0]));
  return albedo.map((a, k) => a * (light * [1.5, 1.37, 1.15][k] + bounce * [1, 0.97, 0.92][k]));
}
