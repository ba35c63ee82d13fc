#include "deploy/sim/room/room.hpp"

#include <algorithm>

#include <gmock/gmock.h>

namespace fleetloc {
namespace {

TEST(Room, FurnitureHidesWhatIsBehindItButNotItsOwnFront) {
  const Room room;
  const Eigen::Vector3d above_table{0.2, -0.1, 2.0};
  EXPECT_TRUE(room.is_in_sight(above_table, {0.2, -0.1, 0.76}));  // the table's top
  EXPECT_FALSE(room.is_in_sight(above_table, {0.2, -0.1, 0.0}));  // the floor below
  EXPECT_TRUE(room.is_in_sight(above_table, {3.0, 0.0, 0.0}));
  EXPECT_TRUE(room.is_in_sight({-3.0, 1.8, 1.0}, {-4.25, 1.8, 1.0}));  // front of the cupboard
  EXPECT_FALSE(room.is_in_sight({-3.0, 1.8, 1.0}, {-5.0, 1.8, 1.0}));  // the wall behind
}

TEST(Room, PointsLieOnSurfacesThatCanBeSeen) {
  const Room room;
  const auto points = room.random_surface_points(500, CounterRandom(1, 0));
  ASSERT_EQ(points.size(), 500U);
  int on_furniture = 0;
  for (const Eigen::Vector3d& p : points) {
    EXPECT_LE(std::abs(p.x()), 5.0 + 1e-9);
    EXPECT_LE(std::abs(p.y()), 4.0 + 1e-9);
    const bool is_wall = std::abs(p.x()) > 5.0 - 1e-9 || std::abs(p.y()) > 4.0 - 1e-9 ||
                         p.z() < 1e-9 || p.z() > 4.0 - 1e-9;
    const auto distance_to_face = [&](const Room::Box& box) {
      const Eigen::Vector3d p_box = inverse(box.T_room_box) * p;
      return std::abs((p_box.cwiseAbs() - box.half_size).maxCoeff());
    };
    const bool is_face = std::any_of(room.furniture().begin(),
                                     room.furniture().end(),
                                     [&](auto& b) { return distance_to_face(b) < 1e-9; });
    EXPECT_TRUE(is_wall || is_face) << p.transpose();
    on_furniture += is_face && !is_wall ? 1 : 0;
  }
  EXPECT_GT(on_furniture, 30);
}

TEST(Room, AGridHasAboutOnePointPerSpacingSquared) {
  const Room room;
  const auto coarse = static_cast<double>(room.surface_grid(0.2).size());
  const auto fine = static_cast<double>(room.surface_grid(0.1).size());
  EXPECT_NEAR(fine / coarse, 4.0, 0.3);
  EXPECT_GT(fine * 0.01, 280.0);  // the bare room has 304 m^2, furniture adds to it
  EXPECT_LT(fine * 0.01, 390.0);
}

}  // namespace
}  // namespace fleetloc
