// Values that several tests start from.
import type { Job, Scene } from "../src/contract";

export const kScene: Scene = {
  id: "6f1ed002ab5595859014ebf0951522d9f1d2f4a4ef9f0a3f9d7a5f0b2c3d4e5f",
  name: "spider", kind: "zip", bytes: 91023, created_at: "2026-01-01T00:00:00Z", triangles: 1368,
  materials: 5, lights: { point: 1, emitting_triangles: 0 },
  cameras: [{ index: 0, name: "front" }, { index: 1, name: "top" }],
  warnings: [], tree: null, cache: "absent",
};

export function job(changes: Partial<Job> = {}): Job {
  return {
    id: "j_1", scene: kScene.id, name: "", state: "rendering", revision: 5,
    created_at: "2026-01-01T00:00:00Z", started_at: "2026-01-01T00:00:01Z", finished_at: null,
    request: { scene: kScene.id, width: 640, height: 480, stop: { samples: 64 } },
    queue_position: null, prepare: null,
    progress: { fraction: 0.25, samples_done: 16, samples_target: 64, tiles_done: 0, tiles_total: 80 },
    elapsed_seconds: 2, remaining_seconds: 6, statistics: {}, warnings: [], error: null, image: null,
    ...changes,
  };
}
