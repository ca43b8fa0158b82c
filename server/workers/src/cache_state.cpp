#include "cache_state.hpp"

#include <algorithm>
#include <cstdio>
#include <exception>
#include <new>

#include "raykiln/render/prepared_bytes.hpp"
#include "raykiln/scene/environment_map.hpp"
#include "raykiln/scene/surface_textures.hpp"
#include "raykiln/workers/scene_tree.hpp"

namespace raykiln::server {
namespace {

/// The map and the table that is made of it for sampling.
std::uint64_t environment_bytes(const render::Scene& scene) {
  if (scene.environment == nullptr) return 0;
  const std::uint64_t values = scene.environment->rgb.size();
  return values * sizeof(float) + values / 3 * sizeof(double);
}

std::uint64_t texture_bytes(const render::Scene& scene) {
  if (scene.textures == nullptr) return 0;
  std::uint64_t bytes = 0;
  for (const auto& image : scene.textures->images) {
    bytes += image.srgb8.size() + image.linear.size() * sizeof(float);
  }
  for (const auto& set : scene.textures->uv_sets) {
    bytes += set.coordinates.size() * sizeof(render::Vec2f) +
             set.corners.size() * sizeof(std::array<std::uint32_t, 3>);
  }
  return bytes + scene.textures->materials.size() * sizeof(render::MaterialTextures);
}

std::uint64_t bytes_of(const render::Scene& scene) {
  const auto& mesh = scene.mesh;
  return sizeof(scene) + mesh.positions.size() * sizeof(render::Vec3f) +
         mesh.triangles.size() * sizeof(mesh.triangles[0]) +
         mesh.material_ids.size() * sizeof(mesh.material_ids[0]) +
         mesh.normals.size() * sizeof(render::Vec3f) +
         mesh.corner_normals.size() * sizeof(mesh.corner_normals[0]) +
         mesh.objects.size() * sizeof(render::ObjectRun) + scene.object_names.size() * sizeof(std::string) +
         scene.materials.size() * sizeof(render::Material) +
         scene.point_lights.size() * sizeof(render::PointLight) +
         scene.spot_lights.size() * sizeof(render::SpotLight) +
         scene.directional_lights.size() * sizeof(render::DirectionalLight) + environment_bytes(scene) +
         texture_bytes(scene);
}

std::string tree_key(const render::Scene& scene, const TreeBudget& settled) {
  const render::BuildParams p = build_params(settled);
  char text[200];
  std::snprintf(text, sizeof text, "%d %a %a %a %a %d %d", render::kKdTreeVersion, p.k_t, p.k_i,
                p.empty_factor, p.max_duplication, p.max_depth, p.leaf_width);
  return "tree " + geometry_digest(scene) + ' ' + text;
}

std::string import_key(const std::string& scene_id) { return scene_key(scene_id) + "imported"; }

Error stopped() { return {ErrorKind::kUnavailable, "import_stopped", "nobody waits any more", ""}; }

class Ticket final : public PrepareTicket {
 public:
  explicit Ticket(std::function<void()> drop) : drop_(std::move(drop)) {}
  ~Ticket() override { drop_(); }
  Ticket(const Ticket&) = delete;
  Ticket& operator=(const Ticket&) = delete;

 private:
  std::function<void()> drop_;
};

}  // namespace

std::string scene_key(const std::string& scene_id) { return "scene " + scene_id + ' '; }

std::string ready_key(const std::string& scene_id, const TreeBudget& budget) {
  return scene_key(scene_id) + "with " + tree_budget_text(budget);
}

SceneCache::State::State(const WorkerSettings& settings, Parts parts)
    : kept(settings.scene_cache_bytes),
      wide_tree_bytes_(settings.wide_tree_bytes),
      parts_(std::move(parts)),
      builds_(parts_.metrics.counter("raykiln_tree_builds_total", "kd-trees that were built")),
      imports_(parts_.metrics.counter("raykiln_scene_imports_total", "scenes read for rendering")),
      hits_(parts_.metrics.counter("raykiln_scene_cache_hits_total", "scenes found ready")),
      bytes_(parts_.metrics.gauge("raykiln_scene_cache_bytes", "scenes and trees kept in memory")) {
  if (!parts_.build) parts_.build = build_tree;
  for (int i = 0; i < std::max(1, settings.preparing_threads); ++i) {
    threads_.emplace_back([this] { work(); });
  }
}

void SceneCache::State::stop() {
  {
    const std::scoped_lock lock(mutex);
    stopping_ = true;
    for (const auto& entry : flights) entry.second->stop();
  }
  wake_.notify_all();
  tree_ended_.notify_all();
  for (auto& thread : threads_) thread.join();
}

CacheState SceneCache::State::state(const std::string& scene_id, const TreeBudget& budget) const {
  const auto key = kept_key(scene_id, budget);
  if (key && kept.contains(*key)) return CacheState::kReady;
  return flights.contains(ready_key(scene_id, budget)) ? CacheState::kBuilding : CacheState::kAbsent;
}

/// Under which a scene that is ready is kept: by what its budget comes to. Nothing while the scene is not in memory,
/// which stays as long as anything that was made of it.
std::optional<std::string> SceneCache::State::kept_key(const std::string& scene_id, const TreeBudget& budget) const {
  const Kept* import = kept.find(import_key(scene_id));
  if (import == nullptr) return std::nullopt;
  const render::Scene& scene = *std::get<ImportedScene>(*import);
  if (!check_tree_budget(scene, budget)) return std::nullopt;
  return ready_key(scene_id, settled_budget(scene, budget, wide_tree_bytes_));
}

void SceneCache::State::forget(const std::string& scene_id) {
  for (const std::string& key : kept.keys_with(scene_key(scene_id))) kept.erase(key);
  reports.erase(scene_id);
}

std::optional<ReadyScene> SceneCache::State::ready(const std::string& scene_id, const TreeBudget& budget) {
  const auto key = kept_key(scene_id, budget);
  auto found = key ? kept.use(*key) : std::nullopt;
  if (!found) return std::nullopt;
  ReadyScene scene = std::get<ReadyScene>(*found);
  // Tree and import after the scene: they are dropped last, so that their bytes stay counted while a
  // scene that is kept refers to them.
  (void)kept.use(scene.tree_key);
  (void)kept.use(import_key(scene_id));
  scene.built_now = false;
  return scene;
}

std::unique_ptr<PrepareTicket> SceneCache::State::prepare(const std::shared_ptr<State>& self,
                                                          const std::string& scene_id,
                                                          const TreeBudget& budget, Flight::Waiter waiter) {
  std::unique_lock lock(mutex);
  if (auto scene = ready(scene_id, budget)) {
    lock.unlock();
    hits_.add();
    waiter.done(std::move(*scene));
    return std::make_unique<Ticket>([] {});
  }
  auto& flight = flights[ready_key(scene_id, budget)];
  auto seat = flight ? flight->join(waiter) : std::nullopt;
  if (!seat) {
    flight = std::make_shared<Flight>(scene_id, budget);
    seat = flight->join(waiter);
    queue_.push_back(flight);
    wake_.notify_one();
  }
  return std::make_unique<Ticket>(
      [self, held = flight, id = *seat] { self->drop(held, id); });
}

void SceneCache::State::drop(const std::shared_ptr<Flight>& flight, std::uint64_t waiter) {
  if (!flight->leave(waiter)) return;
  end(flight);
  tree_ended_.notify_all();  // it may be waiting for another's build
}

void SceneCache::State::end(const std::shared_ptr<Flight>& flight) {
  const std::scoped_lock lock(mutex);
  const auto found = flights.find(ready_key(flight->scene_id, flight->budget));
  if (found != flights.end() && found->second == flight) flights.erase(found);
}

void SceneCache::State::work() {
  while (true) {
    std::shared_ptr<Flight> flight;
    {
      std::unique_lock lock(mutex);
      wake_.wait(lock, [&] { return stopping_ || !queue_.empty(); });
      if (stopping_) return;
      flight = std::move(queue_.front());
      queue_.pop_front();
    }
    const Result<ReadyScene> result = flight->wanted() ? guarded_fly(flight) : stopped();
    end(flight);
    flight->finish(result);
  }
}

/// Border of one preparation.
Result<ReadyScene> SceneCache::State::guarded_fly(const std::shared_ptr<Flight>& flight) {
  try {
    return fly(flight);
  } catch (const std::bad_alloc&) {
    return Error{ErrorKind::kInternal, "render_failed", "out of memory while preparing the scene", ""};
  } catch (const std::exception& fault) {
    return Error{ErrorKind::kInternal, "render_failed", fault.what(), ""};
  }
}

Result<SceneCache::State::ImportedScene> SceneCache::State::imported(const Flight& flight) {
  const std::string& id = flight.scene_id;
  {
    const std::scoped_lock lock(mutex);
    if (auto found = kept.use(import_key(id))) return std::get<ImportedScene>(*found);
  }
  auto record = parts_.store.scene(id);
  if (!record) return record.error();
  auto files = parts_.store.scene_files(id);
  if (!files) return files.error();
  imports_.add();
  auto loaded = parts_.intake.load(record->kind, *files, MissingTextures::kLeaveOut, flight.token());
  if (!loaded) return loaded.error();
  const std::scoped_lock lock(mutex);
  if (!flight.wanted()) return stopped();  // the scene may have been deleted meanwhile
  return keep_imported(id, loaded->scene, "");
}

/// The import that is kept: this one, or another's that came before, so that one is held and counted.
/// Precondition: the mutex is held.
SceneCache::State::ImportedScene SceneCache::State::keep_imported(const std::string& scene_id,
                                                                  ImportedScene scene,
                                                                  const std::string& beside) {
  const std::string key = import_key(scene_id);
  if (auto found = kept.use(key)) return std::get<ImportedScene>(*found);
  keep(key, scene, bytes_of(*scene), {beside});
  return scene;
}

Result<ReadyScene> SceneCache::State::fly(const std::shared_ptr<Flight>& flight) {
  const std::string& id = flight->scene_id;
  {
    const std::scoped_lock lock(mutex);
    if (auto scene = ready(id, flight->budget)) return std::move(*scene);
  }
  flight->report({PrepareStage::kImporting, 0.0});
  auto source = imported(*flight);
  if (!source) return source.error();
  if (auto fits = check_tree_budget(**source, flight->budget); !fits) return fits.error();
  const TreeBudget settled = settled_budget(**source, flight->budget, wide_tree_bytes_);
  const std::string key = tree_key(**source, settled);
  auto tree = obtain_tree(flight, **source, settled, key);
  if (!tree) return tree.error();
  ReadyScene scene{*source, render::prepare(*source, tree->tree.tree), tree->tree.report, tree->built_now, key};
  const std::scoped_lock lock(mutex);
  if (!flight->wanted()) return stopped();  // nothing of a deleted scene is put back
  if (auto same = ready(id, flight->budget)) {  // by another budget that comes to this one
    same->built_now = tree->built_now;
    return std::move(*same);
  }
  // Another scene may have driven import and tree out meanwhile: what is kept is counted with all it holds.
  if (!kept.contains(key)) keep(key, tree->tree, tree->tree.report.stats.bytes, {import_key(id)});
  std::uint64_t bytes = render::prepared_bytes(*scene.prepared);
  if (keep_imported(id, *source, key) != *source) bytes += bytes_of(**source);
  keep(ready_key(id, settled), scene, bytes, {key, import_key(id)});
  reports[id] = scene.tree;
  return scene;
}

void SceneCache::State::keep(const std::string& key, Kept value, std::uint64_t bytes,
                             std::initializer_list<std::string> beside) {
  kept.insert(key, std::move(value), bytes, beside);
  bytes_.set(static_cast<double>(kept.bytes()));
}

bool SceneCache::State::is_wanted(const TreeFlight& tree_flight) const {
  const std::scoped_lock lock(mutex);
  for (const auto& flight : tree_flight.flights) {
    if (flight->wanted()) return true;
  }
  return false;
}

void SceneCache::State::report(const TreeFlight& tree_flight, double fraction) const {
  std::set<std::shared_ptr<Flight>> flights_now;
  {
    const std::scoped_lock lock(mutex);
    flights_now = tree_flight.flights;
  }
  for (const auto& flight : flights_now) flight->report({PrepareStage::kBuilding, fraction});
}

std::optional<BuiltTree> SceneCache::State::build(TreeFlight& tree_flight,
                                                  const render::Scene& scene, const TreeBudget& budget) {
  const auto runner = parts_.pool.task_runner(
      [&](double fraction) { report(tree_flight, fraction); },
      [&] { return !is_wanted(tree_flight); });
  report(tree_flight, 0.0);
  const SteadyTime begin = parts_.clock.steady();
  auto tree = parts_.build(scene, budget, *runner);
  if (!tree) return std::nullopt;
  builds_.add();
  const double seconds = seconds_between(begin, parts_.clock.steady());
  const render::BuildStats stats = render::build_stats(*tree);
  parts_.log.info("tree_built", {{"triangles", stats.triangles}, {"seconds", seconds}});
  return BuiltTree{std::move(tree), {seconds, stats}};
}

Result<SceneCache::State::NewTree> SceneCache::State::obtain_tree(
    const std::shared_ptr<Flight>& flight, const render::Scene& scene, const TreeBudget& settled, const std::string& key) {
  std::unique_lock lock(mutex);
  while (flight->wanted()) {
    if (auto found = kept.use(key)) return NewTree{std::get<BuiltTree>(*found), false};
    auto& slot = tree_flights_[key];
    if (slot) {
      // Somebody builds this very tree: wait with him, and keep him going.
      const auto other = slot;
      other->flights.insert(flight);
      tree_ended_.wait(lock, [&] { return other->ended || !flight->wanted(); });
      other->flights.erase(flight);
      continue;
    }
    const auto mine = std::make_shared<TreeFlight>();
    slot = mine;
    mine->flights.insert(flight);
    lock.unlock();
    std::optional<BuiltTree> built;
    std::exception_ptr fault;
    try {
      built = build(*mine, scene, settled);
    } catch (...) {
      fault = std::current_exception();
    }
    lock.lock();
    mine->ended = true;
    tree_flights_.erase(key);
    if (built) keep(key, *built, built->report.stats.bytes);
    tree_ended_.notify_all();
    if (fault) std::rethrow_exception(fault);
    if (built) return NewTree{std::move(*built), true};
  }
  return stopped();
}

}  // namespace raykiln::server
