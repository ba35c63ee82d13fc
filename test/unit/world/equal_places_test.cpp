// Worlds in which places look alike: deploy/worlds/facades.yaml and garage.yaml.
#include <cmath>
#include <filesystem>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "deploy/sim/motion/motion_config.hpp"
#include "deploy/sim/world/scene.hpp"
#include "deploy/sim/world/season_scene.hpp"

namespace fleetloc {
namespace {

using testing::HasSubstr;

const std::filesystem::path kWorlds =
    std::filesystem::path(FLEETLOC_SOURCE_DIR) / "deploy" / "worlds";

/// A motion of the horizontal plane.
struct PlaneMotion {
  float yaw_rad = 0.0F;
  Eigen::Vector2f shift_m = Eigen::Vector2f::Zero();

  [[nodiscard]] Eigen::Vector3f turned(const Eigen::Vector3f& v) const {
    return Eigen::AngleAxisf(yaw_rad, Eigen::Vector3f::UnitZ()) * v;
  }
  [[nodiscard]] Eigen::Vector3f moved(const Eigen::Vector3f& p) const {
    return turned(p) + Eigen::Vector3f(shift_m.x(), shift_m.y(), 0.0F);
  }
};

constexpr float kHalfTurn = std::numbers::pi_v<float>;

class EqualPlaces {
 public:
  EqualPlaces(const std::string& scene, const std::string& route)
      : world_(read_world_config(ConfigReader::from_file(kWorlds / scene))),
        scene_(build_scene(world_.scene, waypoints(route), 1)),
        survey_(apply_season(
            scene_, season_named(world_, world_.survey), season_named(world_, world_.survey))) {}

  /// Share of the rays from `p`, in all directions that cameras see, that end as far away from the
  /// place to which `motion` takes them. Rays that go farther than `reach_m` at both say nothing.
  [[nodiscard]] double equal_share(const Eigen::Vector3f& p,
                                   const PlaneMotion& motion,
                                   float reach_m) const {
    constexpr int kAround = 180;
    constexpr float kEqual_m = 0.01F;
    int seen = 0;
    int equal = 0;
    for (int i = 0; i < kAround; ++i) {
      const float around = 2.0F * kHalfTurn * (static_cast<float>(i) + 0.37F) / kAround;
      for (const float up : {-0.2F, -0.05F, 0.03F, 0.11F, 0.3F}) {
        const Eigen::Vector3f ray =
            Eigen::Vector3f(std::cos(around), std::sin(around), up).normalized();
        const float here = distance(p, ray, reach_m);
        const float there = distance(motion.moved(p), motion.turned(ray), reach_m);
        if (here >= reach_m && there >= reach_m) continue;
        ++seen;
        equal += std::abs(here - there) < kEqual_m ? 1 : 0;
      }
    }
    return seen == 0 ? 0.0 : static_cast<double>(equal) / seen;
  }

 private:
  static std::vector<Eigen::Vector3d> waypoints(const std::string& route) {
    return driven_waypoints(read_route(kWorlds / route));
  }
  [[nodiscard]] float distance(const Eigen::Vector3f& p,
                               const Eigen::Vector3f& ray,
                               float reach_m) const {
    const auto hit = survey_.fixed().first_hit({p, ray}, reach_m);
    return hit ? hit->distance_m : reach_m;
  }

  WorldConfig world_;
  Scene scene_;
  SeasonScene survey_;
};

// Edges of surfaces are hit or missed by rounding.
constexpr double kAll = 0.985;
// Of places that differ; ground and ceiling are as far away everywhere.
constexpr double kSome = 0.9;

class Facades : public testing::Test {
 protected:
  static void SetUpTestSuite() { world_ = new EqualPlaces("facades.yaml", "facades-loop.yaml"); }
  static void TearDownTestSuite() { delete world_; }
  static constexpr float kPeriod_m = 24.0F;
  static EqualPlaces* world_;
};
EqualPlaces* Facades::world_ = nullptr;

TEST_F(Facades, AreTheSameOneHouseFurtherOn) {
  for (const float x : {80.0F, 111.0F, 142.5F, 200.0F, 225.0F}) {
    EXPECT_GE(world_->equal_share({x, 0.3F, 0.1F}, {.shift_m = {kPeriod_m, 0.0F}}, 45.0F), kAll)
        << x;
  }
}

TEST_F(Facades, AreTheSameFromOneEndOfAStreetToTheOther) {
  EXPECT_GE(world_->equal_share({80.0F, 0.3F, 0.1F}, {.shift_m = {7 * kPeriod_m, 0.0F}}, 45.0F),
            kAll);
}

TEST_F(Facades, AreTheSameInTheOtherStreetAndInTheOtherDirection) {
  const Eigen::Vector3f p(130.0F, -0.2F, 0.1F);
  EXPECT_GE(world_->equal_share(p, {.shift_m = {0.0F, 110.0F}}, 45.0F), kAll);
  EXPECT_GE(world_->equal_share(p, {.yaw_rad = kHalfTurn, .shift_m = {330.0F, 0.0F}}, 45.0F), kAll);
  EXPECT_GE(world_->equal_share(p, {.yaw_rad = kHalfTurn, .shift_m = {330.0F, 110.0F}}, 45.0F),
            kAll);
}

TEST_F(Facades, AreNotTheSameHalfAHouseFurtherOn) {
  EXPECT_LT(world_->equal_share({130.0F, 0.0F, 0.1F}, {.shift_m = {0.5F * kPeriod_m, 0.0F}}, 45.0F),
            kSome);
}

TEST_F(Facades, EndAtCornersThatDiffer) {
  const PlaneMotion to_other_end{.yaw_rad = kHalfTurn, .shift_m = {330.0F, 110.0F}};
  EXPECT_LT(world_->equal_share({330.0F, 30.0F, 0.1F}, to_other_end, 45.0F), kSome);
  EXPECT_LT(world_->equal_share({330.0F, 55.0F, 0.1F}, to_other_end, 45.0F), kSome);
}

class Garage : public testing::Test {
 protected:
  static void SetUpTestSuite() { world_ = new EqualPlaces("garage.yaml", "garage-loop.yaml"); }
  static void TearDownTestSuite() { delete world_; }
  static constexpr float kBay_m = 5.0F;
  static EqualPlaces* world_;
};
EqualPlaces* Garage::world_ = nullptr;

TEST_F(Garage, IsTheSameOneBayFurtherOn) {
  for (const float x : {-18.0F, -7.3F, 0.0F, 11.0F}) {
    EXPECT_GE(world_->equal_share({x, -8.0F, 0.1F}, {.shift_m = {kBay_m, 0.0F}}, 20.0F), kAll) << x;
  }
}

TEST_F(Garage, IsTheSameAfterHalfATurn) {
  for (const float x : {-43.0F, -30.0F, 0.0F, 11.0F, 41.0F}) {
    EXPECT_GE(world_->equal_share({x, -8.0F, 0.1F}, {.yaw_rad = kHalfTurn}, 100.0F), kAll) << x;
  }
  EXPECT_GE(world_->equal_share({43.0F, 2.0F, 0.1F}, {.yaw_rad = kHalfTurn}, 100.0F), kAll);
}

TEST_F(Garage, IsNotTheSameHalfABayFurtherOn) {
  EXPECT_LT(world_->equal_share({0.0F, -8.0F, 0.1F}, {.shift_m = {0.5F * kBay_m, 0.0F}}, 20.0F),
            kSome);
}

TEST(Rows, InTheWayOfTheRobotAreRefused) {
  WorldConfig world = read_world_config(ConfigReader::from_file(kWorlds / "garage.yaml"));
  const std::vector<Eigen::Vector3d> route = {{-43.0, -5.0, 0.0}, {43.0, -5.0, 0.0}};
  try {
    build_scene(world.scene, route, 1);
    FAIL() << "was built";
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), HasSubstr("row 'bays': what stands at x -37.5, y -5.3"));
  }
}

std::string refusal(const std::string& items) {
  try {
    read_rows(ConfigReader::from_string(
        "r: {first: [0, 0], step_m: [1, 0], count: 2, items: " + items + "}"));
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "taken";
}

TEST(Rows, OfUnknownOrIncompleteItemsAreRefused) {
  EXPECT_EQ(refusal("[{kind: pole, at: [0, 3]}]"), "taken");
  EXPECT_THAT(refusal("[]"), HasSubstr("r.items: is empty"));
  EXPECT_THAT(refusal("[{kind: tower, at: [0, 3]}]"), HasSubstr("'tower' is none of building"));
  EXPECT_THAT(refusal("[{kind: box, at: [0, 3]}]"), HasSubstr("size_m"));
  EXPECT_THAT(refusal("[{kind: box, at: [0, 3, 1], size_m: [1, 1, 1]}]"),
              HasSubstr("at: must be 2 numbers"));
  EXPECT_THAT(refusal("[{kind: box, at: [0, .nan], size_m: [1, 1, 1]}]"), HasSubstr("at: nan"));
  EXPECT_THAT(refusal("[{kind: pole, at: [0, 3], colour: red}]"), HasSubstr("colour"));
}

}  // namespace
}  // namespace fleetloc
