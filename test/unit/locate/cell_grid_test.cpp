#include "cloud/locate/cell_grid.hpp"

#include <map>
#include <tuple>

#include <gtest/gtest.h>

#include "shared/core/counter_random.hpp"

namespace fleetloc {
namespace {

TEST(CellGrid, KeepsTheLargestOfEachCellAndIsZeroElsewhere) {
  const Eigen::Vector3i min(-13, 5, -2);
  const Eigen::Vector3i max(22, 30, 9);
  CellGrid grid(min, max);
  std::map<std::tuple<int, int, int>, std::uint8_t> expected;
  const CounterRandom random(1, 1);
  for (std::uint64_t i = 0; i < 500; ++i) {
    Eigen::Vector3i cell;
    for (int axis = 0; axis < 3; ++axis) {
      const double share = random.uniform(i, static_cast<std::uint64_t>(axis));
      cell(axis) = min(axis) + static_cast<int>(share * (max(axis) - min(axis)));
    }
    const auto value = static_cast<std::uint8_t>(1.0 + 254.0 * random.uniform(i, 3));
    grid.raise(cell, value);
    std::uint8_t& kept = expected[{cell.x(), cell.y(), cell.z()}];
    kept = std::max(kept, value);
  }
  for (int z = min.z() - 20; z < max.z() + 20; ++z) {
    for (int y = min.y() - 20; y < max.y() + 20; ++y) {
      for (int x = min.x() - 20; x < max.x() + 20; ++x) {
        const auto found = expected.find({x, y, z});
        ASSERT_EQ(grid.at(x, y, z), found == expected.end() ? 0 : found->second)
            << x << ' ' << y << ' ' << z;
      }
    }
  }
  std::size_t visited = 0;
  grid.for_each([&](const Eigen::Vector3i& cell, std::uint8_t value) {
    EXPECT_EQ((expected[{cell.x(), cell.y(), cell.z()}]), value);
    ++visited;
  });
  EXPECT_EQ(visited, expected.size());
}

TEST(CellGrid, TakesMemoryWhereSomethingIs) {
  CellGrid grid({0, 0, 0}, {800, 600, 40});
  const std::size_t empty = grid.bytes();
  EXPECT_LT(empty, 200'000U);
  for (int i = 0; i < 8; ++i) grid.raise({i, i, i}, 1);
  EXPECT_EQ(grid.bytes(), empty + 512U);
  EXPECT_EQ(CellGrid().at(0, 0, 0), 0);
}

TEST(CellGrid, IsMadeOfItsPartsAndOfNoOthers) {
  const Eigen::Vector3i min(-3, 2, 0);
  const Eigen::Vector3i max(10, 9, 5);
  CellGrid grid(min, max);
  grid.raise({9, 8, 4}, 7);
  const auto& directory = grid.directory();
  const auto& bricks = grid.bricks();
  const auto whole = CellGrid::of_parts(min, max, directory, bricks);
  ASSERT_TRUE(whole);
  EXPECT_EQ(whole->at(9, 8, 4), 7);

  EXPECT_FALSE(CellGrid::of_parts(max, min, directory, bricks)) << "a box inside out";
  EXPECT_FALSE(CellGrid::of_parts(min, {10, 9, 50}, directory, bricks)) << "another box";
  const Eigen::Vector3i far = Eigen::Vector3i::Constant(1 << 30);
  EXPECT_FALSE(CellGrid::of_parts(-far, far, {}, bricks)) << "its cells cannot be counted";
  EXPECT_FALSE(CellGrid::of_parts({0, 0, 0}, {1000, 1000, 0}, {}, bricks)) << "a box without cells";
  EXPECT_FALSE(CellGrid::of_parts(far, far + max - min, directory, bricks)) << "a box too far away";
  EXPECT_FALSE(CellGrid::of_parts(min, {10, 9, 4}, directory, bricks)) << "a cell beyond the box";
  EXPECT_FALSE(CellGrid::of_parts(min, max, directory, {})) << "no bricks";
  auto few = bricks;
  few.pop_back();
  EXPECT_FALSE(CellGrid::of_parts(min, max, directory, few)) << "a brick is missing";
  auto not_empty = bricks;
  not_empty.front()[0] = 1;
  EXPECT_FALSE(CellGrid::of_parts(min, max, directory, not_empty)) << "where nothing is";
}

}  // namespace
}  // namespace fleetloc
