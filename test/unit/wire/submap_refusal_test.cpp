#include <limits>

#include <gtest/gtest.h>
#include <idl/submap.h>

#include "shared/wire/submap_codec.hpp"
#include "test/unit/wire/samples.hpp"

namespace fleetloc {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

void expect_submap_refused(Malformed reason, const std::function<void(wire::Submap&)>& corrupt) {
  expect_refused<wire::Submap>(some_submap(), decode_submap, reason, corrupt);
}

TEST(SubmapRefusal, AnIdThatIsNotOne) {
  expect_submap_refused(Malformed::kInvalidId, [](auto& sample) { sample.robot(""); });
  expect_submap_refused(Malformed::kInvalidId, [](auto& sample) { sample.robot("*"); });
}

TEST(SubmapRefusal, NoKeyframes) {
  expect_submap_refused(Malformed::kTooFewItems, [](auto& sample) {
    sample = wire::Submap();
    sample.robot("robot_1");
  });
}

TEST(SubmapRefusal, MoreItemsThanTheLimit) {
  expect_submap_refused(Malformed::kTooManyItems,
                        [](auto& sample) { sample.keyframe_id().resize(65); });
  expect_submap_refused(Malformed::kTooManyItems,
                        [](auto& sample) { sample.edge_from().resize(65); });
  expect_submap_refused(Malformed::kTooManyItems,
                        [](auto& sample) { sample.landmark_id().resize(8193); });
  expect_submap_refused(Malformed::kTooManyItems,
                        [](auto& sample) { sample.observation_landmark().resize(16385); });
}

TEST(SubmapRefusal, KeyframeColumnsOfUnequalLength) {
  constexpr auto kReason = Malformed::kUnequalColumns;
  expect_submap_refused(kReason, [](auto& sample) { sample.keyframe_revision().pop_back(); });
  expect_submap_refused(kReason, [](auto& sample) { sample.keyframe_stamp_ns().pop_back(); });
  expect_submap_refused(kReason, [](auto& sample) { sample.keyframe_rotation().pop_back(); });
  expect_submap_refused(kReason, [](auto& sample) { sample.keyframe_translation().clear(); });
  expect_submap_refused(kReason, [](auto& sample) { sample.keyframe_tilt_sigma().push_back(1); });
  expect_submap_refused(kReason, [](auto& sample) { sample.keyframe_observations().pop_back(); });
}

TEST(SubmapRefusal, EdgeColumnsOfUnequalLength) {
  constexpr auto kReason = Malformed::kUnequalColumns;
  expect_submap_refused(kReason, [](auto& sample) { sample.edge_to().pop_back(); });
  expect_submap_refused(kReason, [](auto& sample) { sample.edge_revision().pop_back(); });
  expect_submap_refused(kReason, [](auto& sample) { sample.edge_rotation().pop_back(); });
  expect_submap_refused(kReason, [](auto& sample) { sample.edge_translation().pop_back(); });
  expect_submap_refused(kReason, [](auto& sample) { sample.edge_information().pop_back(); });
}

TEST(SubmapRefusal, LandmarkAndObservationColumnsOfUnequalLength) {
  constexpr auto kReason = Malformed::kUnequalColumns;
  expect_submap_refused(kReason, [](auto& sample) { sample.landmark_id_wide().pop_back(); });
  expect_submap_refused(kReason, [](auto& sample) { sample.landmark_position().pop_back(); });
  expect_submap_refused(kReason, [](auto& sample) { sample.landmark_id()[1] = 0; });
  expect_submap_refused(kReason, [](auto& sample) { sample.observation_landmark()[1] = 0; });
  expect_submap_refused(kReason, [](auto& sample) { sample.observation_left_u().pop_back(); });
  expect_submap_refused(kReason, [](auto& sample) { sample.observation_left_v().clear(); });
  expect_submap_refused(kReason, [](auto& sample) { sample.observation_disparity().clear(); });
  expect_submap_refused(kReason, [](auto& sample) { --sample.keyframe_observations()[0]; });
}

TEST(SubmapRefusal, ItemsOutOfOrder) {
  constexpr auto kReason = Malformed::kUnorderedItems;
  expect_submap_refused(kReason,
                        [](auto& sample) { sample.keyframe_id()[1] = sample.keyframe_id()[0]; });
  expect_submap_refused(kReason, [](auto& sample) { sample.edge_from()[0] = 1; });
  expect_submap_refused(kReason, [](auto& sample) { sample.edge_to()[0] = 2; });
  expect_submap_refused(kReason, [](auto& sample) {
    sample.landmark_id()[1] = 0;
    sample.landmark_id_wide().push_back(5);
  });
  expect_submap_refused(kReason, [](auto& sample) {
    sample.observation_landmark()[1] = 0;
    sample.observation_landmark_wide().push_back(0);
  });
}

TEST(SubmapRefusal, StampsOutOfOrder) {
  expect_submap_refused(Malformed::kUnorderedStamps,
                        [](auto& sample) { sample.keyframe_stamp_ns()[2] = 5; });
}

TEST(SubmapRefusal, AnEdgeOfAKeyframeThatIsNotThere) {
  expect_submap_refused(Malformed::kUnknownKeyframe, [](auto& sample) { sample.edge_to()[1] = 3; });
  expect_submap_refused(Malformed::kUnknownKeyframe,
                        [](auto& sample) { sample.edge_from()[0] = 255; });
}

TEST(SubmapRefusal, AnObservationOfALandmarkThatIsNotThere) {
  expect_submap_refused(Malformed::kUnknownLandmark,
                        [](auto& sample) { sample.observation_landmark()[4] = 200; });
}

TEST(SubmapRefusal, NumbersThatAreNotFinite) {
  constexpr auto kReason = Malformed::kNotFinite;
  expect_submap_refused(kReason, [](auto& sample) { sample.origin_odom().y(kNaN); });
  expect_submap_refused(kReason, [](auto& sample) { sample.keyframe_tilt_sigma()[1] = kInfinity; });
  expect_submap_refused(kReason, [](auto& sample) { sample.edge_information()[30] = kNaN; });
  expect_submap_refused(kReason, [](auto& sample) { sample.landmark_position()[2] = kNaN; });
}

TEST(SubmapRefusal, NumbersOutOfRange) {
  constexpr auto kReason = Malformed::kOutOfRange;
  expect_submap_refused(kReason, [](auto& sample) { sample.origin_odom().z(1e9); });
  expect_submap_refused(kReason, [](auto& sample) { sample.keyframe_translation()[2] = 1; });
  expect_submap_refused(kReason, [](auto& sample) { sample.keyframe_tilt_sigma()[1] = 0.0F; });
  expect_submap_refused(kReason, [](auto& sample) { sample.keyframe_tilt_sigma()[1] = 4.0F; });
  expect_submap_refused(kReason, [](auto& sample) { sample.edge_information()[30] = 1e10F; });
  expect_submap_refused(kReason, [](auto& sample) { sample.landmark_position()[2] = -1e7F; });
  expect_submap_refused(kReason, [](auto& sample) {
    sample.keyframe_stamp_ns()[0] = std::numeric_limits<std::int64_t>::min();
  });
  expect_submap_refused(kReason, [](auto& sample) {
    sample.landmark_id()[1] = 0;
    sample.landmark_id_wide().push_back(4'294'967'295);  // the gaps behind it lead beyond an id
  });
}

TEST(SubmapRefusal, RotationsThatAreNotUnit) {
  constexpr auto kReason = Malformed::kNotARotation;
  expect_submap_refused(kReason, [](auto& sample) { sample.keyframe_rotation()[4] = 1 << 30; });
  expect_submap_refused(kReason,
                        [](auto& sample) { std::ranges::fill(sample.edge_rotation(), 0); });
}

}  // namespace
}  // namespace fleetloc
