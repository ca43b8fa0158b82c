// The scene of the page's tests: a lit box, as files and with faults.
const kObj = `mtllib box.mtl
v -1 -1 -1
v 1 -1 -1
v 1 1 -1
v -1 1 -1
v -1 -1 1
v 1 -1 1
v 1 1 1
v -1 1 1
usemtl grey
f 1 4 3 2
f 5 6 7 8
f 1 2 6 5
f 4 8 7 3
f 1 5 8 4
usemtl red
f 2 3 7 6
`;
const kMtl = "newmtl grey\nKd 0.7 0.7 0.7\nnewmtl red\nKd 0.8 0.1 0.1\n";
const kSidecar = {
  camera: { eye: [3, 2, 5], look_at: [0, 0, 0], up: [0, 1, 0], fov_deg: 45 },
  background: [0.2, 0.3, 0.4],
  point_lights: [{ position: [3, 4, 5], intensity: [60, 60, 60] }],
};

const file = (name, text) => ({ name, mimeType: "application/octet-stream", buffer: Buffer.from(text) });

/** `tag` makes another scene id of the same picture. */
export const box_files = (tag = "") => [
  file("box.obj", kObj), file("box.mtl", `${kMtl}# ${tag}\n`), file("raykiln.json", JSON.stringify(kSidecar)),
];

/** A material that cannot be read, on line 2. */
export const bad_files = () => [file("box.obj", kObj), file("box.mtl", "newmtl grey\nKd oops\n")];
