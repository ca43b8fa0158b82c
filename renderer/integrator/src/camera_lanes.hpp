// Camera rays of kLanes paths at once. CameraRays::ray() (camera_ray.cpp) is the reference, with path_key()
// (sampling/random.hpp): same operations, same order, same bits.
#pragma once

#include "camera_query.hpp"
#include "lane_numbers.hpp"

namespace raykiln::render {
namespace {

inline V3 everywhere(const double (&v)[3]) { return {all(v[0]), all(v[1]), all(v[2])}; }

struct LanePathKeys {
  U64 a, b, point;
};

inline LanePathKeys path_keys(std::uint64_t seed_word, U64 pixel, U64 sample, bool sobol) {
  U64 word = sample, point{};
  if (sobol) {
    const U64 index = ((sample >> 6) << 4) | (sample & 15U);
    word = ~(((sample >> 4) & 3U) | ((index >> 32) << 2));
    point = (std::uint64_t{1} << 32) |
            __builtin_convertvector(reversed(__builtin_convertvector(index, U32)), U64);
  }
  const U64 s = U64{} + seed_word;
  const U64 p = mix(s ^ pixel, U64{} + kGolden);
  const U64 a = mix(p + word * kGolden, s);
  return {a, mix(a + kRootTwo, p ^ (word * kRootTwo)), point};
}

/// One axis of entry(): what is left of the part of the rays that lies in the box, and whether any can be.
struct Inside {
  F64 enter, leave;
  I64 beside;
};
inline void clip(Inside& inside, double eye, F64 direction, double lo, double hi) {
  const I64 along = direction == 0.0;
  const bool between = lo <= eye && eye <= hi;
  inside.beside |= between ? I64{} : along;
  const F64 t0 = (lo - eye) / direction, t1 = (hi - eye) / direction;
  inside.enter = select(along, inside.enter, larger(inside.enter, smaller(t0, t1)));
  inside.leave = select(along, inside.leave, smaller(inside.leave, larger(t0, t1)));
}

inline void shoot(const CameraQuery& query, std::size_t first) {
  const std::size_t left = query.count - first;
  const std::size_t count = left < kLanes ? left : kLanes;
  alignas(64) std::uint64_t pixels[kLanes], samples[kLanes];
  alignas(64) double place[2][kLanes];
  for (std::size_t i = 0; i < kLanes; ++i) {
    const LaneStart& start = query.starts[first + (i < count ? i : 0)];
    const std::int32_t x = start.x + query.window_x, y = start.y + query.window_y;
    pixels[i] = (static_cast<std::uint64_t>(y) << 32) | static_cast<std::uint32_t>(x);
    samples[i] = start.sample;
    place[0][i] = x;
    place[1][i] = y;
  }
  const LanePathKeys key = path_keys(query.seed_word, load<U64>(pixels), load<U64>(samples), query.sobol);
  Pair in_pixel{all(0.5), all(0.5)};
  if (query.in_pixel) {
    in_pixel = last_pair(query.sobol, vertex_keys(key.a, key.b, key.point, U64{}, U64{}), 0, 0, query.sobol_third);
  }
  const F64 x = load<F64>(place[0]) + in_pixel.u, y = load<F64>(place[1]) + in_pixel.v;
  const V3 way = everywhere(query.corner) + x * everywhere(query.step_x) + y * everywhere(query.step_y);
  const V3 towards = (1.0 / root(dot(way, way))) * way;
  Inside inside{F64{}, all(__builtin_inf()), I64{}};
  clip(inside, query.eye[0], towards.x, query.lo[0], query.hi[0]);
  clip(inside, query.eye[1], towards.y, query.lo[1], query.hi[1]);
  clip(inside, query.eye[2], towards.z, query.lo[2], query.hi[2]);
  const I64 met = (inside.enter <= inside.leave) & ~inside.beside;
  const F64 distance = select(met, inside.enter, all(-1.0));
  const V3 eye = everywhere(query.eye);
  const V3f o = narrow(select(distance > 0.0, eye + distance * towards, eye));
  const V3f d = narrow(towards);
  const F32 t_max = narrow(select(met, all(__builtin_inf()), F64{}));

  alignas(64) std::uint64_t words[3][kLanes];
  alignas(64) float ray[7][kLanes];
  store(words[0], key.a);
  store(words[1], key.b);
  store(words[2], key.point);
  store(ray[0], o.x);
  store(ray[1], o.y);
  store(ray[2], o.z);
  store(ray[3], d.x);
  store(ray[4], d.y);
  store(ray[5], d.z);
  store(ray[6], t_max);
  for (std::size_t i = 0; i < count; ++i) {
    query.rays[first + i] = {{ray[0][i], ray[1][i], ray[2][i]}, 0.0F, {ray[3][i], ray[4][i], ray[5][i]}, ray[6][i]};
    query.paths[first + i] = {.key_a = words[0][i], .key_b = words[1][i], .point = words[2][i],
                              .throughput = {1.0, 1.0, 1.0}, .scale = 1.0, .pdf = 0.0, .node = 0,
                              .slot = query.first_slot + static_cast<std::uint32_t>(first + i),
                              .bounce = 0, .met_diffuse = false};
  }
}

void shoot_camera_lanes(const CameraQuery& query) {
  for (std::size_t first = 0; first < query.count; first += kLanes) shoot(query, first);
}

}  // namespace
}  // namespace raykiln::render
