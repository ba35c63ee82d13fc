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
  void add_level(double z, float planarity = 1.0F) {
    for (double x = -3.0; x <= 3.0; x += 0.1) {
      for (double y = -3.0; y <= 3.0; y += 0.1) add({x, y, z}, Eigen::Vector3f::UnitZ(), planarity);
    }
  }
  void add_wall() {
    for (double y = -3.0; y <= 3.0; y += 0.1) {
      for (double z = 0.0; z <= 10.0; z += 0.1) add({0.0, y, z}, Eigen::Vector3f::UnitX(), 1.0F);
    }
  }
  [[nodiscard]] std::vector<double> storeys(double x, double ground_m) const {
    MapInfo info;
    info.max = {3.0, 3.0, 10.0};
    return storeys_above(LaserMap(points_, info), {x, 0.0}, ground_m);
  }

  void add(const Eigen::Vector3d& p, const Eigen::Vector3f& normal, float planarity) {
    points_.push_back({.p_map = p.cast<float>(), .normal = normal, .planarity = planarity});
  }

 private:
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
  add_level(1.9);        // the roof of a car
  add_level(4.0, 0.2F);  // leaves
  add_wall();
  EXPECT_THAT(storeys(0.0, 0.0), IsEmpty());
}

TEST_F(StoreysTest, AreNotHigherForADeskBesideTheRobot) {
  add_level(4.0);
  for (double x = 0.8; x <= 1.6; x += 0.1) {
    for (double y = -0.4; y <= 0.4; y += 0.1) add({x, y, 4.75}, Eigen::Vector3f::UnitZ(), 1.0F);
  }
  EXPECT_THAT(storeys(0.0, 0.0), ElementsAre(DoubleNear(4.0, 1e-6)));
}

TEST_F(StoreysTest, AreSeenBesideAHole) {
  add_level(5.0);
  EXPECT_THAT(storeys(3.9, 0.0), ElementsAre(DoubleNear(5.0, 1e-6)));
  EXPECT_THAT(storeys(5.0, 0.0), IsEmpty());
}

}  // namespace
}  // namespace fleetloc
