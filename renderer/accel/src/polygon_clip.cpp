#include "polygon_clip.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <limits>

namespace raykiln::render {
namespace {

using Double2 = double __attribute__((vector_size(16)));
using Long2 = std::int64_t __attribute__((vector_size(16)));
using Float4 = float __attribute__((vector_size(16)));
using Int4 = std::int32_t __attribute__((vector_size(16)));
using Cell = PartsClip::Cell;

// x, y, z and a zero.
struct alignas(16) Point {
  std::array<double, 4> x;

  [[nodiscard]] Double2 half(std::size_t i) const {
    Double2 v;
    std::memcpy(&v, x.data() + 2 * i, sizeof v);
    return v;
  }
  void set_half(std::size_t i, Double2 v) { std::memcpy(x.data() + 2 * i, &v, sizeof v); }
};

template <typename Vector, typename T>
Vector loaded(const T* from) {
  Vector v;
  std::memcpy(&v, from, sizeof v);
  return v;
}

Float4 to_float(const Point& p) {
  const Double2 xy = p.half(0), z = p.half(1);
  return Float4{static_cast<float>(xy[0]), static_cast<float>(xy[1]), static_cast<float>(z[0]), 0.0F};
}
Int4 lanes_where(const Point& p, const Float4& f, bool above) {
  const auto differs = [&](double x, float y) {
    const auto rounded = static_cast<double>(y);
    return (above ? rounded < x : rounded > x) ? 1 : 0;
  };
  return Int4{differs(p.x[0], f[0]), differs(p.x[1], f[1]), differs(p.x[2], f[2]), 0};
}

// The next float below or above where the nearest is on the wrong side, as std::nextafter gives it:
// floats are in the order of their bits, taken as a sign and a number.
Float4 stepped(const Float4& f, const Int4& steps) {
  constexpr std::int32_t kNumber = 0x7FFFFFFF;
  const auto bits = loaded<Int4>(&f);
  Int4 sign = bits >> 31;
  const Int4 order = (((bits & kNumber) ^ sign) - sign) + steps;
  sign = order >> 31;
  const Int4 back = ((order ^ sign) - sign) | (sign & ~kNumber);
  return loaded<Float4>(&back);
}
Float4 rounded_down(const Point& p) {
  const Float4 f = to_float(p);
  return stepped(f, -lanes_where(p, f, false));
}
Float4 rounded_up(const Point& p) {
  const Float4 f = to_float(p);
  return stepped(f, lanes_where(p, f, true));
}
Float4 clamped(const Float4& x, const Float4& lo, const Float4& hi) {
  const Float4 least = x < lo ? lo : x;
  return hi < least ? hi : least;
}

// Outwards to float, and no further than the cell.
void write(const Point& lo, const Point& hi, const Cell& cell, Reference& to) {
  const auto cell_lo = loaded<Float4>(cell.lo.data()), cell_hi = loaded<Float4>(cell.hi.data());
  const Float4 first = clamped(rounded_down(lo), cell_lo, cell_hi) + 0.0F;  // -0 becomes +0
  const Float4 last = clamped(rounded_up(hi), cell_lo, cell_hi) + 0.0F;
  std::memcpy(&to, std::array{first, last}.data(), sizeof to);
}

// A convex polygon that is cut to a cell, plane by plane.
class Cut {
 public:
  explicit Cut(const std::array<Vec3f, 3>& corners) : n_(3) {
    for (std::size_t i = 0; i < 3; ++i) {
      p_[i].x = {static_cast<double>(corners[i].x), static_cast<double>(corners[i].y),
                 static_cast<double>(corners[i].z), 0.0};
    }
    measure();
  }
  Cut(const Cut& other) : n_(other.n_), lo_(other.lo_), hi_(other.hi_) {
    std::copy_n(other.p_, n_, p_);
  }
  Cut& operator=(const Cut&) = delete;
  ~Cut() = default;

  /// Keeps what lies between two planes across an axis; false when nothing does.
  bool keep(std::size_t axis, double lo, double hi) {
    const bool below = lo_.x[axis] < lo;
    const bool above = hi_.x[axis] > hi;
    if (!below && !above) return true;
    if (below) clip(axis, lo, -1.0);
    if (n_ == 0) return false;
    if (above) clip(axis, hi, 1.0);
    if (n_ == 0) return false;
    measure();
    return true;
  }
  bool keep(std::size_t first_axis, std::size_t end_axis, const Cell& cell) {
    for (std::size_t k = first_axis; k < end_axis; ++k) {
      if (!keep(k, static_cast<double>(cell.lo[k]), static_cast<double>(cell.hi[k]))) return false;
    }
    return true;
  }

  void write_bounds(const Cell& cell, Reference& to) const { write(lo_, hi_, cell, to); }

 private:
  // Sutherland & Hodgman 1974: keeps the side sign * (x - plane) <= 0, the plane included.
  void clip(std::size_t axis, double plane, double sign) {
    const Point* const given = p_;
    const std::size_t n = n_;
    p_ = given == buffers_[0].data() ? buffers_[1].data() : buffers_[0].data();
    n_ = 0;
    double da = sign * (given[0].x[axis] - plane);
    for (std::size_t i = 0; i < n; ++i) {
      const Point& a = given[i];
      const Point& b = given[i + 1 == n ? 0 : i + 1];
      const double db = sign * (b.x[axis] - plane);
      if (da <= 0.0 && n_ < 9) p_[n_++] = a;
      if (((da < 0.0 && db > 0.0) || (da > 0.0 && db < 0.0)) && n_ < 9) {
        cut(a, b, axis, plane, p_[n_++]);
      }
      da = db;
    }
  }

  // Where the edge a-b meets the plane, with the coordinate of the plane itself, not a rounded one.
  static void cut(const Point& a, const Point& b, std::size_t axis, double plane, Point& c) {
    const double s = (plane - a.x[axis]) / (b.x[axis] - a.x[axis]);
    for (std::size_t i = 0; i < 2; ++i) c.set_half(i, a.half(i) + (b.half(i) - a.half(i)) * s);
    c.x[axis] = plane;
  }

  void measure() {
    for (std::size_t h = 0; h < 2; ++h) {
      Double2 lo = p_[0].half(h);
      Double2 hi = lo;
      for (std::size_t i = 1; i < n_; ++i) {
        const Double2 x = p_[i].half(h);
        lo = x < lo ? x : lo;
        hi = x > hi ? x : hi;
      }
      lo_.set_half(h, lo);
      hi_.set_half(h, hi);
    }
  }

  std::array<std::array<Point, 9>, 2> buffers_;  ///< each of six planes adds at most one corner to the three
  Point* p_ = buffers_[0].data();
  std::size_t n_;
  Point lo_, hi_;
};

// A triangle of which nothing but the plane of the split cuts anything off: the cuts of the three
// edges serve both parts, and what does not count is replaced, without a branch, by what does.
class PlainCut {
 public:
  PlainCut(const std::array<Vec3f, 3>& corners, std::size_t axis, double plane) {
    for (std::size_t i = 0; i < 3; ++i) {
      p_[i].x = {static_cast<double>(corners[i].x), static_cast<double>(corners[i].y),
                 static_cast<double>(corners[i].z), 0.0};
    }
    std::array<double, 3> d;
    for (std::size_t i = 0; i < 3; ++i) d[i] = p_[i].x[axis] - plane;
    std::array<std::int64_t, 3> crosses, in_left, in_right;
    std::array<double, 3> s;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t j = i == 2 ? 0 : i + 1;
      crosses[i] = -static_cast<std::int64_t>(((d[i] < 0.0) & (d[j] > 0.0)) | ((d[i] > 0.0) & (d[j] < 0.0)));
      in_left[i] = -static_cast<std::int64_t>(d[i] <= 0.0);
      in_right[i] = -static_cast<std::int64_t>(d[i] >= 0.0);
      s[i] = (plane - p_[i].x[axis]) / (p_[j].x[axis] - p_[i].x[axis]);
    }
    for (std::size_t h = 0; h < 2; ++h) {
      Double2 cut_lo = all_of(std::numeric_limits<double>::infinity());
      Double2 cut_hi = -cut_lo;
      Double2 left_lo = cut_lo, left_hi = cut_hi, right_lo = cut_lo, right_hi = cut_hi;
      for (std::size_t i = 0; i < 3; ++i) {
        const Double2 a = p_[i].half(h), b = p_[i == 2 ? 0 : i + 1].half(h);
        const Double2 c = a + (b - a) * s[i];
        keep(c, crosses[i], cut_lo, cut_hi);
        keep(a, in_left[i], left_lo, left_hi);
        keep(a, in_right[i], right_lo, right_hi);
      }
      left_lo_.set_half(h, cut_lo < left_lo ? cut_lo : left_lo);
      left_hi_.set_half(h, cut_hi > left_hi ? cut_hi : left_hi);
      right_lo_.set_half(h, cut_lo < right_lo ? cut_lo : right_lo);
      right_hi_.set_half(h, cut_hi > right_hi ? cut_hi : right_hi);
    }
    // Cuts lie in the plane, wherever their rounding led.
    left_lo_.x[axis] = std::min({p_[0].x[axis], p_[1].x[axis], p_[2].x[axis]});
    right_hi_.x[axis] = std::max({p_[0].x[axis], p_[1].x[axis], p_[2].x[axis]});
    left_hi_.x[axis] = right_lo_.x[axis] = plane;
  }

  /// The rounding of a cut may lead out of the cell: then it is cut there, too.
  [[nodiscard]] bool is_all(std::size_t axis, const Cell& left, const Cell& right) const {
    bool all = true;
    for (std::size_t k = axis + 1; k < 3; ++k) {
      all &= left_lo_.x[k] >= static_cast<double>(left.lo[k]) &&
             left_hi_.x[k] <= static_cast<double>(left.hi[k]) &&
             right_lo_.x[k] >= static_cast<double>(right.lo[k]) &&
             right_hi_.x[k] <= static_cast<double>(right.hi[k]);
    }
    return all;
  }
  void write_bounds(const Cell& left_cell, const Cell& right_cell, Reference& left,
                    Reference& right) const {
    write(left_lo_, left_hi_, left_cell, left);
    write(right_lo_, right_hi_, right_cell, right);
  }

 private:
  static Double2 all_of(double x) { return Double2{x, x}; }
  static void keep(const Double2& x, std::int64_t counts, Double2& lo, Double2& hi) {
    const Long2 mask{counts, counts};
    const Double2 low = mask ? x : lo, high = mask ? x : hi;
    lo = low < lo ? low : lo;
    hi = high > hi ? high : hi;
  }

  std::array<Point, 3> p_;
  Point left_lo_, left_hi_, right_lo_, right_hi_;
};

/// The triangle lies in the cell, and on both sides of the plane.
bool is_cut_by_plane_only(const std::array<Vec3f, 3>& corners, std::size_t axis, const Cell& left,
                          const Cell& right) {
  Float4 lo{corners[0].x, corners[0].y, corners[0].z, 0.0F};
  Float4 hi = lo;
  for (std::size_t i = 1; i < 3; ++i) {
    const Float4 x{corners[i].x, corners[i].y, corners[i].z, 0.0F};
    lo = x < lo ? x : lo;
    hi = x > hi ? x : hi;
  }
  const Int4 outside = (lo < loaded<Float4>(left.lo.data())) | (hi > loaded<Float4>(right.hi.data()));
  const auto words = loaded<std::array<std::int64_t, 2>>(&outside);
  return (words[0] | words[1]) == 0 && lo[axis] < left.hi[axis] && hi[axis] > left.hi[axis];
}

}  // namespace

PartsClip::Cell::Cell(const Bounds3f& box) {
  for (int k = 0; k < 3; ++k) {
    lo[static_cast<std::size_t>(k)] = box.lo[k];
    hi[static_cast<std::size_t>(k)] = box.hi[k];
  }
}

PartsClip::PartsClip(const Bounds3f& left_cell, const Bounds3f& right_cell, int axis)
    : axis_(static_cast<std::size_t>(axis)), left_(left_cell), right_(right_cell) {}

PartsClip::Found PartsClip::run(const std::array<Vec3f, 3>& corners, Reference& left,
                                Reference& right) const {
  if (is_cut_by_plane_only(corners, axis_, left_, right_)) {
    const PlainCut plain(corners, axis_, static_cast<double>(left_.hi[axis_]));
    if (plain.is_all(axis_, left_, right_)) {
      plain.write_bounds(left_, right_, left, right);
      return {true, true};
    }
  }
  // Both parts are cut alike across the axes before that of the split.
  Cut part(corners);
  if (!part.keep(0, axis_, left_)) return {};
  Cut other(part);
  const Found found{part.keep(axis_, 3, left_), other.keep(axis_, 3, right_)};
  if (found.left) part.write_bounds(left_, left);
  if (found.right) other.write_bounds(right_, right);
  return found;
}

std::optional<Bounds3f> clipped_bounds(const std::array<Vec3f, 3>& corners, const Bounds3f& box) {
  const Cell cell(box);
  Cut part(corners);
  if (!part.keep(0, 3, cell)) return std::nullopt;
  Reference to;
  part.write_bounds(cell, to);
  Bounds3f bounds;
  for (int k = 0; k < 3; ++k) {
    bounds.lo[k] = to.lo[static_cast<std::size_t>(k)];
    bounds.hi[k] = to.hi[static_cast<std::size_t>(k)];
  }
  return bounds;
}

}  // namespace raykiln::render
