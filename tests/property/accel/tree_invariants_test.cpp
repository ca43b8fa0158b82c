// What must hold in every tree, whatever the mesh and the parameters.
#include <cmath>
#include <set>

#include "polygon_clip.hpp"
#include "sah_sweep.hpp"
#include "subtree_builder.hpp"
#include "support/accel_testing.hpp"

namespace raykiln::test {
namespace {

using render::Bounds3f;
using render::BuildParams;
using render::KdNode;
using render::KdTree;

struct LeafView {
  Bounds3f cell;
  std::vector<std::uint32_t> ids;
};

/// Reads a tree by its arrays alone and checks the structure on the way.
class Reader {
 public:
  explicit Reader(const KdTree& tree) : tree_(tree), seen_(tree.nodes.size(), 0) {
    seen_[0] = seen_[1] = 1;
    read(0, tree.box, 0);
    for (const int times : seen_) EXPECT_EQ(times, 1) << "every node has one parent";
    render::with_blocks(tree, [&](const auto& blocks) { EXPECT_EQ(blocks_, blocks.size()); });
  }

  std::vector<LeafView> leaves;
  int depth = 0;
  std::size_t inner = 0, references = 0;
  double cost = 0.0;

 private:
  void read(std::uint32_t index, const Bounds3f& cell, int at_depth) {
    const KdNode node = tree_.nodes[index];
    depth = std::max(depth, at_depth);
    const double share = render::surface_area(cell) / render::surface_area(tree_.box);
    if (render::is_leaf(node)) {
      read_leaf(node, cell);
      const double n = static_cast<double>(leaves.back().ids.size());
      if (n > 0) cost += tree_.params.k_i * n * share;
      return;
    }
    ++inner;
    cost += tree_.params.k_t * share;
    const std::uint32_t left = render::left_child(node);
    const auto axis = static_cast<int>(render::split_axis(node));
    const float split = render::split_position(node);
    ASSERT_EQ(left % 2, 0U);
    ASSERT_GT(left, index);
    ASSERT_LT(left + 1, tree_.nodes.size());
    ASSERT_GT(split, cell.lo[axis]) << "strictly inside";
    ASSERT_LT(split, cell.hi[axis]) << "strictly inside";
    ++seen_[left];
    ++seen_[left + 1];
    Bounds3f low = cell;
    Bounds3f high = cell;
    low.hi[axis] = high.lo[axis] = split;
    read(left, low, at_depth + 1);
    read(left + 1, high, at_depth + 1);
  }

  void read_leaf(KdNode node, const Bounds3f& cell) {
    LeafView leaf{cell, {}};
    render::with_blocks(tree_, [&](const auto& blocks) {
      const std::uint32_t first = render::first_block(node);
      const std::uint32_t count = render::block_count(node);
      ASSERT_LE(std::size_t{first} + count, blocks.size());
      for (std::uint32_t b = first; b < first + count; ++b) {
        read_block(blocks[b], b + 1 == first + count, leaf.ids);
      }
      blocks_ += count;
    });
    EXPECT_TRUE(std::is_sorted(leaf.ids.begin(), leaf.ids.end()));
    EXPECT_EQ(std::set<std::uint32_t>(leaf.ids.begin(), leaf.ids.end()).size(), leaf.ids.size());
    references += leaf.ids.size();
    leaves.push_back(std::move(leaf));
  }

  template <int W>
  void read_block(const render::LeafBlock<W>& block, bool last, std::vector<std::uint32_t>& ids) {
    ASSERT_NE(block.id[0], render::kNoHit);
    bool padding = false;
    for (std::size_t lane = 0; lane < W; ++lane) {
      if (block.id[lane] == render::kNoHit) {
        padding = true;
        ASSERT_TRUE(last);
        continue;
      }
      ASSERT_FALSE(padding) << "padding stands at the end";
      ASSERT_LT(block.id[lane], tree_.triangles.size());
      const auto& t = tree_.triangles[block.id[lane]];
      for (std::size_t c = 0; c < 3; ++c) {
        for (std::size_t k = 0; k < 3; ++k) {
          ASSERT_EQ(block.v[c][k][lane], tree_.positions[t[c]][static_cast<int>(k)]);
        }
      }
      ids.push_back(block.id[lane]);
    }
  }

  const KdTree& tree_;
  std::vector<int> seen_;
  std::size_t blocks_ = 0;
};

bool contains(const Bounds3f& cell, const Vec3f& p, float slack) {
  for (int k = 0; k < 3; ++k) {
    if (!(p[k] >= cell.lo[k] - slack && p[k] <= cell.hi[k] + slack)) return false;
  }
  return true;
}

struct Case {
  const char* name;
  TestMesh mesh;
  BuildParams params;
};

std::vector<Case> cases() {
  BuildParams deep;
  deep.k_i = 4.0;
  deep.leaf_width = 16;
  BuildParams poor;
  poor.k_i = 2.0;
  poor.max_duplication = 1.2;
  BuildParams shallow;
  shallow.max_depth = 3;
  return {{"soup", soup(2000, 1), {}},          {"soup_deep", soup(600, 2, 3.0F), deep},
          {"terrain", terrain(24), {}},         {"slivers", slivers(300), deep},
          {"slivers_poor", slivers(300), poor}, {"room", box_room(8), deep},
          {"sphere_shallow", sphere(40, 20), shallow}, {"flat", coplanar_grid(20), deep},
          {"hair", hair(60, 10), poor},         {"one", soup(1), {}}};
}

TEST(TreeInvariants, StructureAndStatisticsAreConsistent) {
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.name);
    const auto tree = build(c.mesh, c.params);
    const Reader reader(*tree);
    const auto& stats = render::build_stats(*tree);
    EXPECT_EQ(stats.triangles, c.mesh.triangles.size());
    EXPECT_EQ(stats.dropped_degenerate, 0U);
    EXPECT_EQ(stats.inner_nodes, reader.inner);
    EXPECT_EQ(stats.leaves, reader.leaves.size());
    EXPECT_EQ(stats.leaves, stats.inner_nodes + 1);
    EXPECT_EQ(stats.nodes, stats.inner_nodes + stats.leaves);
    EXPECT_EQ(stats.references, reader.references);
    EXPECT_EQ(stats.depth, reader.depth);
    EXPECT_NEAR(stats.sah_cost, reader.cost, 1e-9 * (1.0 + reader.cost));
    const auto n = static_cast<double>(c.mesh.triangles.size());
    EXPECT_LE(reader.depth, std::min(static_cast<double>(c.params.max_depth),
                                     8.0 + 1.3 * std::log2(n)));
    EXPECT_LE(static_cast<double>(reader.references), c.params.max_duplication * n);
    const std::size_t block = c.params.leaf_width == 16 ? tree->blocks16.size() * 640
                                                        : tree->blocks8.size() * 320;
    EXPECT_EQ(stats.bytes, tree->nodes.size() * 8 + block);
  }
}

TEST(TreeInvariants, ReferencesMeetTheirCellAndPointsFindTheirTriangle) {
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.name);
    const auto tree = build(c.mesh, c.params);
    const Reader reader(*tree);
    std::vector<std::vector<const LeafView*>> of_triangle(c.mesh.triangles.size());
    for (const LeafView& leaf : reader.leaves) {
      for (const std::uint32_t id : leaf.ids) {
        EXPECT_TRUE(render::clipped_bounds(c.mesh.corners(id), leaf.cell)) << "triangle " << id;
        of_triangle[id].push_back(&leaf);
      }
    }
    TestRandom random(3);
    for (std::size_t id = 0; id < of_triangle.size(); ++id) {
      for (int i = 0; i < 20; ++i) {
        const Vec3f p = point_on(random, c.mesh.corners(id));  // off the triangle by a few ulp
        const bool found = std::any_of(
            of_triangle[id].begin(), of_triangle[id].end(),
            [&](const LeafView* leaf) { return contains(leaf->cell, p, 5e-7F); });
        EXPECT_TRUE(found) << "triangle " << id;
      }
    }
  }
}

// A triangle with a part of positive area in a cell is listed there: checked where the part is
// large enough for the midpoint of a fine subdivision to be in the cell beyond doubt.
TEST(TreeInvariants, CellsListWhateverLiesClearlyInside) {
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.name);
    const auto tree = build(c.mesh, c.params);
    const Reader reader(*tree);
    TestRandom random(4);
    for (std::size_t trial = 0; trial < 3000; ++trial) {
      const auto id = random.below(static_cast<std::uint32_t>(c.mesh.triangles.size()));
      const Vec3f p = point_on(random, c.mesh.corners(id));
      std::uint32_t node = 0;
      Bounds3f cell = tree->box;
      while (!render::is_leaf(tree->nodes[node])) {
        const KdNode n = tree->nodes[node];
        const auto axis = static_cast<int>(render::split_axis(n));
        const bool right = p[axis] > render::split_position(n);
        (right ? cell.lo : cell.hi)[axis] = render::split_position(n);
        node = render::left_child(n) + (right ? 1U : 0U);
      }
      bool clearly = true;
      for (int k = 0; k < 3; ++k) {
        const bool flat = tree->box.lo[k] == tree->box.hi[k];
        if (!flat && !(p[k] > cell.lo[k] + 1e-6F && p[k] < cell.hi[k] - 1e-6F)) clearly = false;
      }
      if (!clearly) continue;
      const auto leaf = std::find_if(reader.leaves.begin(), reader.leaves.end(), [&](auto& l) {
        return l.cell.lo == cell.lo && l.cell.hi == cell.hi;
      });
      ASSERT_NE(leaf, reader.leaves.end());
      EXPECT_TRUE(std::binary_search(leaf->ids.begin(), leaf->ids.end(), id));
    }
  }
}

TEST(TreeInvariants, ClippedBoundsAreConservative) {
  TestRandom random(5);
  std::size_t inside = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    const std::array<Vec3f, 3> p{random.in_box(0, 1), random.in_box(0, 1), random.in_box(0, 1)};
    const Vec3f a = random.in_box(0, 1);
    const Vec3f b = random.in_box(0, 1);
    const Bounds3f cell{glm::min(a, b), glm::max(a, b)};
    const auto bounds = render::clipped_bounds(p, cell);
    for (int i = 0; i < 8; ++i) {  // points of the triangle in double
      const auto s = static_cast<double>(random.uniform());
      const double t = static_cast<double>(random.uniform()) * (1.0 - s);
      bool in_cell = true;
      std::array<double, 3> q{};
      for (int k = 0; k < 3; ++k) {
        const auto at = [&](std::size_t corner) { return static_cast<double>(p[corner][k]); };
        double& x = q[static_cast<std::size_t>(k)];
        x = at(0) * (1.0 - s - t) + at(1) * s + at(2) * t;
        in_cell = in_cell && x >= static_cast<double>(cell.lo[k]) + 1e-12 &&
                  x <= static_cast<double>(cell.hi[k]) - 1e-12;
      }
      if (!in_cell) continue;
      ++inside;
      ASSERT_TRUE(bounds);
      for (int k = 0; k < 3; ++k) {
        EXPECT_GE(q[static_cast<std::size_t>(k)], static_cast<double>(bounds->lo[k]));
        EXPECT_LE(q[static_cast<std::size_t>(k)], static_cast<double>(bounds->hi[k]));
      }
    }
  }
  EXPECT_GT(inside, 1000U);
}

}  // namespace
}  // namespace raykiln::test
