// The sequences that system tests run on where there are no recordings.
#include "test/system/simulated_flight.hpp"

#include <variant>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "robot/dataset/dataset_reader.hpp"

namespace fleetloc {
namespace {

using ::testing::AllOf;
using ::testing::Ge;
using ::testing::Le;

/// Neither black nor white, with texture, and not the same from both eyes.
void expect_pictures_of_something(const RecordedFlight& flight, std::size_t at_least) {
  DatasetReader reader({.folder = flight.folder});
  EXPECT_THAT(*reader.frame_count(), Ge(at_least));
  while (const auto item = reader.next()) {
    const auto* frame = std::get_if<CameraFrame>(&*item);
    if (frame == nullptr) continue;
    const auto& pair = std::get<StereoFrame>(*frame);
    cv::Scalar mean;
    cv::Scalar deviation;
    cv::meanStdDev(pair.left, mean, deviation);
    EXPECT_THAT(mean[0], AllOf(Ge(60.0), Le(160.0)));
    EXPECT_THAT(deviation[0], Ge(20.0));
    EXPECT_GT(cv::norm(pair.left, pair.right, cv::NORM_L1) / static_cast<double>(pair.left.total()),
              2.0);
  }
}

// Others wait for these two: they make what is not there yet.
TEST(SimulatedFlights, ShowARoom) {
  expect_pictures_of_something(simulated_room(), 120);
}

TEST(SimulatedFlights, ShowAStreet) {
  expect_pictures_of_something(simulated_street(), 20);
}

}  // namespace
}  // namespace fleetloc
