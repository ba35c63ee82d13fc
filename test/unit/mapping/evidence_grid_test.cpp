#include "cloud/mapping/evidence_grid.hpp"

#include <algorithm>
#include <random>
#include <set>

#include <Eigen/Geometry>
#include <gmock/gmock.h>

namespace fleetloc {
namespace {

using Kind = SurfaceCell::Kind;

constexpr double kCell = 0.2;

/// A square of 4 x 4 m about `center`, points 5 cm apart, spanned by two unit vectors.
std::vector<Eigen::Vector3f> plane(const Eigen::Vector3f& center,
                                   const Eigen::Vector3f& u,
                                   const Eigen::Vector3f& v) {
  std::vector<Eigen::Vector3f> points;
  for (int i = -40; i < 40; ++i) {
    for (int j = -40; j < 40; ++j) {
      points.emplace_back(center + 0.05F * (static_cast<float>(i) * u + static_cast<float>(j) * v));
    }
  }
  return points;
}

TEST(EvidenceGrid, FindsTheCellsOfItsPointsAndNoOthers) {
  const EvidenceGrid grid(std::vector<Eigen::Vector3f>{{0.1F, 0.1F, 0.1F}, {-7.3F, 0.1F, 55.0F}},
                          kCell);
  EXPECT_EQ(grid.size(), 2U);
  const auto first = grid.find({0.19, 0.01, 0.1});
  ASSERT_TRUE(first);
  EXPECT_TRUE(grid.cell(*first).p_map.isApprox(Eigen::Vector3f(0.1F, 0.1F, 0.1F)));
  EXPECT_TRUE(grid.find({-7.3, 0.1, 55.0}));
  EXPECT_FALSE(grid.find({0.21, 0.01, 0.1}));
  EXPECT_FALSE(grid.find({-0.01, 0.01, 0.1}));
}

TEST(EvidenceGrid, TraversesEveryCellOfALineOnceAndNoOther) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> uniform(-3.0F, 3.0F);
  std::vector<Eigen::Vector3f> points(4000);
  for (auto& p : points) p = {uniform(random), uniform(random), uniform(random)};
  const EvidenceGrid grid(points, kCell);
  for (int ray = 0; ray < 50; ++ray) {
    const Eigen::Vector3d from = points[static_cast<std::size_t>(ray)].cast<double>();
    const Eigen::Vector3d to = points[static_cast<std::size_t>(ray) + 100].cast<double>();
    std::set<std::size_t> sampled;
    constexpr int kSamples = 20000;
    for (int i = 0; i <= kSamples; ++i) {
      if (const auto index = grid.find(from + (to - from) * i / kSamples)) sampled.insert(*index);
    }
    std::vector<std::size_t> visited;
    grid.traverse(from, to, [&](std::size_t index) { visited.push_back(index); });
    const std::set<std::size_t> distinct(visited.begin(), visited.end());
    EXPECT_EQ(distinct.size(), visited.size());
    EXPECT_TRUE(std::ranges::includes(distinct, sampled));  // samples may jump over a corner
    EXPECT_LE(distinct.size(), sampled.size() + 1);
  }
}

TEST(EvidenceGrid, TraversesAlongAnAxis) {
  const EvidenceGrid grid(
      std::vector<Eigen::Vector3f>{{0.1F, 0.1F, 0.1F}, {-2.9F, 0.1F, 0.1F}, {3.1F, 0.1F, 0.1F}},
      kCell);
  int cells = 0;
  grid.traverse({2.0, 0.1, 0.1}, {-3.0, 0.1, 0.1}, [&](std::size_t) { ++cells; });
  EXPECT_EQ(cells, 2);
}

TEST(EvidenceGrid, KnowsTheNormalOfAPlane) {
  const Eigen::Vector3f u = Eigen::Vector3f(1.0F, 0.5F, 0.0F).normalized();
  const Eigen::Vector3f v = Eigen::Vector3f(-0.2F, 0.4F, 1.0F).normalized();
  const EvidenceGrid grid(plane({0.03F, 0.07F, 0.01F}, u, v), kCell);
  const Eigen::Vector3f normal = u.cross(v).normalized();
  std::size_t planes = 0;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (grid.cell(i).kind != Kind::kPlanar) continue;
    ++planes;
    EXPECT_GT(std::abs(grid.cell(i).normal.dot(normal)), 0.99F);
  }
  EXPECT_GT(planes, grid.size() * 9 / 10);
}

TEST(EvidenceGrid, TakesAnUprightLineForNonPlanarAndALevelOneForUnknown) {
  std::vector<Eigen::Vector3f> upright;
  std::vector<Eigen::Vector3f> level;
  for (int i = 0; i < 100; ++i) {
    upright.emplace_back(0.1F, 0.1F, 0.02F * static_cast<float>(i));
    level.emplace_back(0.02F * static_cast<float>(i), 0.1F, 0.1F);
  }
  const EvidenceGrid pole(upright, kCell);
  for (std::size_t i = 0; i < pole.size(); ++i) EXPECT_EQ(pole.cell(i).kind, Kind::kNonPlanar);
  const EvidenceGrid ring(level, kCell);
  for (std::size_t i = 0; i < ring.size(); ++i) EXPECT_EQ(ring.cell(i).kind, Kind::kUnknown);
}

}  // namespace
}  // namespace fleetloc
