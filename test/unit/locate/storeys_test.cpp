#include "cloud/locate/storeys.hpp"

#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace fleetloc {
namespace {

using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

/// Level surfaces of 6 m x 6 m, and a wall.
class StoreysTest : public testing::Test {
 protected:
  void add_level(double z) {
    for (double x = -3.0; x <= 3.0; x += 0.1) {
      for (double y = -3.0; y <= 3.0; y += 0.1) add({x, y, z}, Eigen::Vector3f::UnitZ());
    }
  }
  void add_wall() {
    for (double y = -3.0; y <= 3.0; y += 0.1) {
      for (double z = 0.0; z <= 10.0; z += 0.1) add({0.0, y, z}, Eigen::Vector3f::UnitX());
    }
  }
  [[nodiscard]] std::vector<double> storeys(double x, double ground_m) const {
    MapInfo info;
    info.max = {3.0, 3.0, 10.0};
    return storeys_above(LaserMap(points_, info), {x, 0.0}, ground_m);
  }

 private:
  void add(const Eigen::Vector3d& p, const Eigen::Vector3f& normal) {
    points_.push_back({.p_map = p.cast<float>(), .normal = normal, .planarity = 1.0F});
  }

  std::vector<MapPoint> points_;
};

TEST_F(StoreysTest, AreTheTopsOfFloors) {
  add_level(0.0);
  add_level(3.0);  // a ceiling
  add_level(3.3);  // and the floor on it
  add_level(7.0);
  EXPECT_THAT(storeys(1.5, 0.0), ElementsAre(DoubleNear(3.3, 1e-6), DoubleNear(7.0, 1e-6)));
  EXPECT_THAT(storeys(1.5, 4.0), ElementsAre(DoubleNear(7.0, 1e-6)));
}

TEST_F(StoreysTest, AreNoneInTheOpen) {
  add_level(0.0);
  add_level(0.8);  // a table
  add_wall();
  EXPECT_THAT(storeys(0.0, 0.0), IsEmpty());
}

TEST_F(StoreysTest, AreSeenBesideAHole) {
  add_level(5.0);
  EXPECT_THAT(storeys(3.9, 0.0), ElementsAre(DoubleNear(5.0, 1e-6)));
  EXPECT_THAT(storeys(5.0, 0.0), IsEmpty());
}

}  // namespace
}  // namespace fleetloc
