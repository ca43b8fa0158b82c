// Triangles on both sides of a plane are clipped for both parts of the cell, in double.
#pragma once

#include "build_kernel_lanes.hpp"

namespace raykiln::render {
namespace {

typedef double Double4 __attribute__((vector_size(32)));
typedef std::int64_t Long4 __attribute__((vector_size(32)));

inline Double4 all_of(double x) { return x - Double4{}; }
inline Double4 lesser(const Double4& x, const Double4& lo) {
#if defined(__AVX2__)
  return _mm256_min_pd(x, lo);
#else
  return x < lo ? x : lo;
#endif
}
inline Double4 greater(const Double4& x, const Double4& hi) {
#if defined(__AVX2__)
  return _mm256_max_pd(x, hi);
#else
  return x > hi ? x : hi;
#endif
}
inline Double4 to_double(const Float4& x) { return __builtin_convertvector(x, Double4); }
/// -1 in the lane of an axis.
inline Long4 lane_of(std::uint32_t axis) { return Long4{0, 1, 2, 3} == static_cast<std::int64_t>(axis); }

/// A cell as clipping needs it.
struct ClipCell {
  Float4 lo, hi;
  explicit ClipCell(const float (&box)[2][4]) : lo(lanes_at<Float4>(box[0])), hi(lanes_at<Float4>(box[1])) {}
};

struct Corners {
  Float4 p[3];
  Corners(const float* a, const float* b, const float* c)
      : p{Float4{a[0], a[1], a[2], 0.0F}, Float4{b[0], b[1], b[2], 0.0F}, Float4{c[0], c[1], c[2], 0.0F}} {}
};

// The next float below or above where the nearest is on the wrong side, as std::nextafter gives it:
// floats are in the order of their bits, taken as a sign and a number.
inline Float4 stepped(const Float4& f, const Int4& steps) {
  constexpr std::int32_t kNumber = 0x7FFFFFFF;
  const auto bits = lanes_at<Int4>(&f);
  Int4 sign = bits >> 31;
  const Int4 order = (((bits & kNumber) ^ sign) - sign) + steps;
  sign = order >> 31;
  const Int4 back = ((order ^ sign) - sign) | (sign & ~kNumber);
  return lanes_at<Float4>(&back);
}
inline Float4 clamped(const Float4& x, const ClipCell& cell) {
  const Float4 least = x < cell.lo ? cell.lo : x;
  return cell.hi < least ? cell.hi : least;
}

// Outwards to float, and no further than the cell.
inline void write_bounds(const Double4& lo, const Double4& hi, const ClipCell& cell, float* to) {
  const Float4 down = __builtin_convertvector(lo, Float4), up = __builtin_convertvector(hi, Float4);
  const Long4 too_high = to_double(down) > lo, too_low = to_double(up) < hi;
  const Float4 first = clamped(stepped(down, __builtin_convertvector(too_high, Int4)), cell) + 0.0F;  // -0 becomes +0
  const Float4 last = clamped(stepped(up, -__builtin_convertvector(too_low, Int4)), cell) + 0.0F;
  __builtin_memcpy(to, &first, sizeof first);
  __builtin_memcpy(to + 4, &last, sizeof last);
}

/// A convex polygon that is cut to a cell, plane by plane.
class Cut {
 public:
  inline explicit Cut(const Corners& c) : n_(3) {
    for (int i = 0; i < 3; ++i) put(p_, static_cast<std::uint32_t>(i), to_double(c.p[i]));
    measure();
  }
  inline Cut(const Cut& other) : n_(other.n_), lo_(other.lo_), hi_(other.hi_) {
    for (std::uint32_t i = 0; i < n_; ++i) put(p_, i, at(other.p_, i));
  }
  Cut& operator=(const Cut&) = delete;
  ~Cut() = default;

  /// Keeps what lies in the cell across some axes; false when nothing does.
  inline bool keep(std::uint32_t first_axis, std::uint32_t end_axis, const ClipCell& cell) {
    for (std::uint32_t k = first_axis; k < end_axis; ++k) {
      const double lo = static_cast<double>(cell.lo[k]), hi = static_cast<double>(cell.hi[k]);
      const bool below = lo_[k] < lo;
      const bool above = hi_[k] > hi;
      if (!below && !above) continue;
      if (below) clip(k, lo, -1.0);
      if (n_ == 0) return false;
      if (above) clip(k, hi, 1.0);
      if (n_ == 0) return false;
      measure();
    }
    return true;
  }
  inline void write(const ClipCell& cell, float* to) const { write_bounds(lo_, hi_, cell, to); }

 private:
  static inline Double4 at(const double* p, std::uint32_t i) { return lanes_at<Double4>(p + 4 * i); }
  static inline void put(double* p, std::uint32_t i, const Double4& x) { __builtin_memcpy(p + 4 * i, &x, sizeof x); }

  // Sutherland & Hodgman 1974: keeps the side sign * (x - plane) <= 0, the plane included. Each corner
  // and each cut is written, and stays if it counts: no branch to mispredict. Where an edge meets the
  // plane the coordinate is that of the plane itself, not a rounded one.
  inline void clip(std::uint32_t axis, double plane, double sign) {
    double* const given = p_;
    double* const kept = given == buffers_[0] ? buffers_[1] : buffers_[0];
    put(given, n_, at(given, 0));
    const Long4 lane = lane_of(axis);
    const Double4 all = all_of(plane);
    std::uint32_t n = 0;
    double xa = given[axis];
    double da = sign * (xa - plane);
    for (std::uint32_t i = 0; i < n_; ++i) {
      const double xb = given[4 * (i + 1) + axis];
      const double db = sign * (xb - plane);
      const Double4 a = at(given, i);
      put(kept, n, a);
      n += (da <= 0.0 ? 1U : 0U) & (n < kMost ? 1U : 0U);
      const Double4 cut = a + (at(given, i + 1) - a) * ((plane - xa) / (xb - xa));
      put(kept, n, lane ? all : cut);
      const std::uint32_t in = da < 0.0 ? 1U : 0U, out = da > 0.0 ? 1U : 0U;
      n += ((in & (db > 0.0 ? 1U : 0U)) | (out & (db < 0.0 ? 1U : 0U))) & (n < kMost ? 1U : 0U);
      da = db;
      xa = xb;
    }
    p_ = kept;
    n_ = n;
  }

  inline void measure() {
    lo_ = hi_ = at(p_, 0);
    for (std::uint32_t i = 1; i < n_; ++i) {
      const Double4 x = at(p_, i);
      lo_ = lesser(x, lo_);
      hi_ = greater(x, hi_);
    }
  }

  static constexpr std::uint32_t kMost = 9;  ///< each of six planes adds at most one corner to the three
  double buffers_[2][4 * (kMost + 2)];
  double* p_ = buffers_[0];
  std::uint32_t n_;
  Double4 lo_, hi_;
};

/// The triangle lies in the cell, and on both sides of the plane.
inline bool is_cut_by_plane_only(const Corners& c, std::uint32_t axis, const ClipCell& left, const ClipCell& right) {
  Float4 lo = c.p[0], hi = c.p[0];
  for (int i = 1; i < 3; ++i) {
    lo = c.p[i] < lo ? c.p[i] : lo;
    hi = c.p[i] > hi ? c.p[i] : hi;
  }
  const Int4 outside = (lo < left.lo) | (hi > right.hi);
  std::uint64_t words[2];
  __builtin_memcpy(words, &outside, sizeof words);
  return (words[0] | words[1]) == 0 && lo[axis] < left.hi[axis] && hi[axis] > left.hi[axis];
}

// Of such a triangle nothing but the plane of the split cuts anything off: the cuts of the three edges
// serve both parts, and what does not count is replaced, without a branch, by what does. False where the
// rounding of a cut leads out of the cell: then it is cut there, too.
inline bool cut_by_plane_only(const Corners& c, std::uint32_t axis, const ClipCell& left, const ClipCell& right,
                              float* to_left, float* to_right) {
  const double plane = static_cast<double>(left.hi[axis]);
  const Double4 p[4] = {to_double(c.p[0]), to_double(c.p[1]), to_double(c.p[2]), to_double(c.p[0])};
  const Double4 x{p[0][axis], p[1][axis], p[2][axis], p[0][axis]};
  const Double4 next{x[1], x[2], x[0], x[1]};
  const Double4 d = x - plane, d_next = next - plane;
  const Long4 crosses = ((d < 0.0) & (d_next > 0.0)) | ((d > 0.0) & (d_next < 0.0));
  const Long4 in_left = d <= 0.0, in_right = d >= 0.0;
  const Double4 share = (plane - x) / (next - x);
  Double4 cut_lo = all_of(static_cast<double>(kInfinite)), cut_hi = -cut_lo;
  Double4 left_lo = cut_lo, left_hi = cut_hi, right_lo = cut_lo, right_hi = cut_hi;
  const auto keep = [](const Double4& point, const Long4& counts, Double4& lo, Double4& hi) {
    lo = lesser(counts ? point : lo, lo);
    hi = greater(counts ? point : hi, hi);
  };
  for (int i = 0; i < 3; ++i) {
    const Double4 s = all_of(share[i]);
    const Double4 cut = p[i] + (p[i + 1] - p[i]) * s;
    keep(cut, crosses[i] - Long4{}, cut_lo, cut_hi);
    keep(p[i], in_left[i] - Long4{}, left_lo, left_hi);
    keep(p[i], in_right[i] - Long4{}, right_lo, right_hi);
  }
  // Cuts lie in the plane, wherever their rounding led.
  const Long4 lane = lane_of(axis);
  const Double4 all = all_of(plane);
  left_lo = lane ? lesser(p[2], lesser(p[1], p[0])) : lesser(cut_lo, left_lo);
  left_hi = lane ? all : greater(cut_hi, left_hi);
  right_lo = lane ? all : lesser(cut_lo, right_lo);
  right_hi = lane ? greater(p[2], greater(p[1], p[0])) : greater(cut_hi, right_hi);
  const Long4 behind = Long4{0, 1, 2, -1} > static_cast<std::int64_t>(axis);
  const Long4 outside = behind & ((left_lo < to_double(left.lo)) | (left_hi > to_double(left.hi)) |
                                  (right_lo < to_double(right.lo)) | (right_hi > to_double(right.hi)));
  std::uint64_t words[4];
  __builtin_memcpy(words, &outside, sizeof words);
  if ((words[0] | words[1] | words[2] | words[3]) != 0) return false;
  write_bounds(left_lo, left_hi, left, to_left);
  write_bounds(right_lo, right_hi, right, to_right);
  return true;
}

/// Bits: something is left of the triangle on the left side, and on the right.
inline unsigned clip_to_parts(const Corners& c, std::uint32_t axis, const ClipCell& left, const ClipCell& right,
                              float* to_left, float* to_right) {
  if (is_cut_by_plane_only(c, axis, left, right) && cut_by_plane_only(c, axis, left, right, to_left, to_right)) {
    return 3;
  }
  // Both parts are cut alike across the axes before that of the split.
  Cut part(c);
  if (!part.keep(0, axis, left)) return 0;
  Cut other(part);
  const bool in_left = part.keep(axis, 3, left), in_right = other.keep(axis, 3, right);
  if (in_left) part.write(left, to_left);
  if (in_right) other.write(right, to_right);
  return (in_left ? 1U : 0U) | (in_right ? 2U : 0U);
}

unsigned clip_references(const ClipQuery& q, const SplitCounts::Both* both, std::uint32_t n, float* left, float* right) {
  const ClipCell left_cell(q.left), right_cell(q.right);
  const auto id_of = [](const float* reference) {
    std::uint32_t id;
    __builtin_memcpy(&id, reference + 3, sizeof id);
    return id;
  };
  const auto set_id = [](float* reference, std::uint32_t id) { __builtin_memcpy(reference + 3, &id, sizeof id); };
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t* const t = q.triangles + 3 * std::size_t{id_of(left + 8 * std::size_t{both[i].left})};
    __builtin_prefetch(q.positions + 3 * std::size_t{t[0]});
    __builtin_prefetch(q.positions + 3 * std::size_t{t[2]} + 2);
  }
  unsigned complete = 3;
  for (std::uint32_t i = 0; i < n; ++i) {
    float* const in_left = left + 8 * std::size_t{both[i].left};
    float* const in_right = right + 8 * std::size_t{both[i].right};
    const std::uint32_t id = id_of(in_left);
    const std::uint32_t* const t = q.triangles + 3 * std::size_t{id};
    const Corners corners(q.positions + 3 * std::size_t{t[0]}, q.positions + 3 * std::size_t{t[1]},
                          q.positions + 3 * std::size_t{t[2]});
    const unsigned found = clip_to_parts(corners, q.axis, left_cell, right_cell, in_left, in_right);
    set_id(in_left, (found & 1U) != 0 ? id : kNoReference);
    set_id(in_right, (found & 2U) != 0 ? id : kNoReference);
    complete &= found;
  }
  return complete;
}

bool clip_triangle(const float* corners, const float (&box)[2][4], float* to) {
  const ClipCell cell(box);
  Cut part(Corners(corners, corners + 3, corners + 6));
  if (!part.keep(0, 3, cell)) return false;
  part.write(cell, to);
  return true;
}

}  // namespace
}  // namespace raykiln::render
