#include "embree_library.hpp"

#include <dlfcn.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstring>

namespace raykiln::bench {
namespace {

using render::Hit;
using render::Occlusion;
using render::Ray;

// Layouts and numbers of Embree 4's C interface. The hit is followed by room for the fields that a
// build with instance arrays adds.
template <std::size_t N>
struct alignas(N == 1 ? 16 : 64) RayBlock {
  using Floats = std::array<float, N>;
  using Words = std::array<std::uint32_t, N>;
  Floats ox, oy, oz, near, dx, dy, dz, time, far;
  Words mask, id, flags;
};
template <std::size_t N>
struct alignas(N == 1 ? 16 : 64) RayHitBlock {
  RayBlock<N> ray;
  typename RayBlock<N>::Floats nx, ny, nz, u, v;
  typename RayBlock<N>::Words triangle, geometry, instance, spare[4];
};
static_assert(sizeof(RayBlock<1>) == 48 && sizeof(RayBlock<16>) == 768);

struct Arguments {
  std::uint32_t flags = 0;
  std::uint32_t features = 0xFFFFFFFFU;
  void* context = nullptr;
  void* filter = nullptr;
  void* intersect = nullptr;
  std::array<std::uint64_t, 4> spare{};
};
constexpr std::uint32_t kCoherent = 1U << 16;
constexpr std::uint32_t kRobust = 1U << 2;
constexpr std::uint32_t kInvalid = 0xFFFFFFFFU;
constexpr int kTriangles = 0;
constexpr int kIndexBuffer = 0;
constexpr int kVertexBuffer = 1;
constexpr int kUint3 = 0x5003;
constexpr int kFloat3 = 0x9003;
constexpr int kVersionProperty = 0;

using Handle = void*;

struct Functions {
  Handle (*new_device)(const char*) = nullptr;
  void (*release_device)(Handle) = nullptr;
  int (*device_error)(Handle) = nullptr;
  std::ptrdiff_t (*device_property)(Handle, int) = nullptr;
  Handle (*new_scene)(Handle) = nullptr;
  void (*release_scene)(Handle) = nullptr;
  void (*scene_quality)(Handle, int) = nullptr;
  void (*scene_flags)(Handle, std::uint32_t) = nullptr;
  void (*commit_scene)(Handle) = nullptr;
  Handle (*new_geometry)(Handle, int) = nullptr;
  void (*release_geometry)(Handle) = nullptr;
  void* (*new_buffer)(Handle, int, unsigned, int, std::size_t, std::size_t) = nullptr;
  void (*geometry_quality)(Handle, int) = nullptr;
  void (*commit_geometry)(Handle) = nullptr;
  unsigned (*attach_geometry)(Handle, Handle) = nullptr;
  void (*intersect1)(Handle, RayHitBlock<1>*, Arguments*) = nullptr;
  void (*intersect16)(const int*, Handle, RayHitBlock<16>*, Arguments*) = nullptr;
  void (*occluded1)(Handle, RayBlock<1>*, Arguments*) = nullptr;
};

template <std::size_t N>
void put(const Ray& ray, std::size_t lane, RayBlock<N>& to) {
  to.ox[lane] = ray.o.x;
  to.oy[lane] = ray.o.y;
  to.oz[lane] = ray.o.z;
  to.near[lane] = ray.t_min;
  to.dx[lane] = ray.d.x;
  to.dy[lane] = ray.d.y;
  to.dz[lane] = ray.d.z;
  to.time[lane] = 0.0F;
  to.far[lane] = ray.t_max;
  to.mask[lane] = kInvalid;
  to.id[lane] = to.flags[lane] = 0;
}

template <std::size_t N>
Hit taken(const RayHitBlock<N>& from, std::size_t lane) {
  if (from.geometry[lane] == kInvalid) return {};
  return {from.ray.far[lane], from.triangle[lane], from.u[lane], from.v[lane]};
}

class Scene final : public EmbreeScene {
 public:
  Scene(const Functions& embree, Handle scene) : embree_(embree), scene_(scene) {}
  ~Scene() override { embree_.release_scene(scene_); }
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;

  void closest(std::span<const Ray> rays, std::span<Hit> hits) const override {
    Arguments arguments;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      RayHitBlock<1> query;
      put(rays[i], 0, query.ray);
      query.geometry[0] = query.instance[0] = kInvalid;
      embree_.intersect1(scene_, &query, &arguments);
      hits[i] = taken(query, 0);
    }
  }

  void closest16(std::span<const Ray> rays, std::span<Hit> hits) const override {
    Arguments arguments;
    arguments.flags = kCoherent;
    for (std::size_t i = 0; i < rays.size(); i += 16) {
      const std::size_t n = std::min<std::size_t>(16, rays.size() - i);
      alignas(64) std::array<int, 16> valid{};
      RayHitBlock<16> query;
      for (std::size_t lane = 0; lane < n; ++lane) {
        valid[lane] = -1;
        put(rays[i + lane], lane, query.ray);
        query.geometry[lane] = query.instance[lane] = kInvalid;
      }
      embree_.intersect16(valid.data(), scene_, &query, &arguments);
      for (std::size_t lane = 0; lane < n; ++lane) hits[i + lane] = taken(query, lane);
    }
  }

  void any(std::span<const Ray> rays, std::span<Occlusion> hits) const override {
    Arguments arguments;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      RayBlock<1> query;
      put(rays[i], 0, query);
      embree_.occluded1(scene_, &query, &arguments);
      hits[i] = query.far[0] < 0.0F ? Occlusion::kOpaque : Occlusion::kNone;
    }
  }

 private:
  const Functions& embree_;
  Handle scene_;
};

class Library final : public EmbreeLibrary {
 public:
  ~Library() override {
    if (device_ != nullptr) embree_.release_device(device_);
  }
  Library() = default;
  Library(const Library&) = delete;
  Library& operator=(const Library&) = delete;

  // The library stays loaded until the process ends: it starts threads of its own.
  bool load(const std::string& path, int threads) {
    library_ = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (library_ == nullptr) return false;
    const bool whole =
        find("rtcNewDevice", embree_.new_device) && find("rtcReleaseDevice", embree_.release_device) &&
        find("rtcGetDeviceError", embree_.device_error) &&
        find("rtcGetDeviceProperty", embree_.device_property) &&
        find("rtcNewScene", embree_.new_scene) && find("rtcReleaseScene", embree_.release_scene) &&
        find("rtcSetSceneBuildQuality", embree_.scene_quality) &&
        find("rtcSetSceneFlags", embree_.scene_flags) &&
        find("rtcCommitScene", embree_.commit_scene) &&
        find("rtcNewGeometry", embree_.new_geometry) &&
        find("rtcReleaseGeometry", embree_.release_geometry) &&
        find("rtcSetNewGeometryBuffer", embree_.new_buffer) &&
        find("rtcSetGeometryBuildQuality", embree_.geometry_quality) &&
        find("rtcCommitGeometry", embree_.commit_geometry) &&
        find("rtcAttachGeometry", embree_.attach_geometry) &&
        find("rtcIntersect1", embree_.intersect1) && find("rtcIntersect16", embree_.intersect16) &&
        find("rtcOccluded1", embree_.occluded1);
    if (!whole) return false;
    const std::string configuration = "threads=" + std::to_string(threads);
    device_ = embree_.new_device(configuration.c_str());
    return device_ != nullptr && embree_.device_property(device_, kVersionProperty) / 10000 == 4;
  }

  std::unique_ptr<EmbreeScene> build(const render::TriangleView& mesh, EmbreeQuality quality,
                                     bool robust) const override {
    const Handle geometry = embree_.new_geometry(device_, kTriangles);
    void* const positions = embree_.new_buffer(geometry, kVertexBuffer, 0, kFloat3,
                                               sizeof(render::Vec3f), mesh.positions.size());
    void* const indices = embree_.new_buffer(geometry, kIndexBuffer, 0, kUint3,
                                             3 * sizeof(std::uint32_t), mesh.triangles.size());
    const Handle scene = embree_.new_scene(device_);
    auto result = std::make_unique<Scene>(embree_, scene);
    if (positions == nullptr || indices == nullptr) return nullptr;
    std::memcpy(positions, mesh.positions.data(), mesh.positions.size_bytes());
    std::memcpy(indices, mesh.triangles.data(), mesh.triangles.size_bytes());
    embree_.geometry_quality(geometry, static_cast<int>(quality));
    embree_.commit_geometry(geometry);
    embree_.scene_quality(scene, static_cast<int>(quality));
    embree_.scene_flags(scene, robust ? kRobust : 0U);
    embree_.attach_geometry(scene, geometry);
    embree_.release_geometry(geometry);
    embree_.commit_scene(scene);
    return embree_.device_error(device_) == 0 ? std::move(result) : nullptr;
  }

  std::string version() const override {
    const std::ptrdiff_t v = embree_.device_property(device_, kVersionProperty);
    std::string text = std::to_string(v / 10000);
    text += '.';
    text += std::to_string(v / 100 % 100);
    text += '.';
    text += std::to_string(v % 100);
    return text;
  }

 private:
  template <typename Function>
  bool find(const char* name, Function& function) {
    function = reinterpret_cast<Function>(dlsym(library_, name));
    return function != nullptr;
  }

  void* library_ = nullptr;
  Handle device_ = nullptr;
  Functions embree_;
};

}  // namespace

std::unique_ptr<EmbreeLibrary> load_embree(const std::string& path, int threads) {
  auto library = std::make_unique<Library>();
  if (library->load(path, threads)) return library;
  const char* const reason = dlerror();
  std::fprintf(stderr, "%s: %s\n", path.c_str(), reason != nullptr ? reason : "not Embree 4");
  return nullptr;
}

}  // namespace raykiln::bench
