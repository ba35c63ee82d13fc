#include "robot/node/dataset_player.hpp"

#include <memory>
#include <stdexcept>

#include <gtest/gtest.h>

namespace fleetloc {
namespace {

/// IMU samples, `step` apart; fails after some if it is told to.
class Samples final : public SensorSource {
 public:
  Samples(int count, Duration step, int failing_at = -1)
      : count_(count), step_(step), failing_at_(failing_at) {}

  std::optional<SensorMeasurement> next(const std::stop_token& stop) override {
    if (given_ == failing_at_) throw std::runtime_error("the file ends here");
    if (given_ == count_ || stop.stop_requested()) return std::nullopt;
    ImuSample sample;
    sample.stamp = Timestamp{step_ * ++given_};
    return sample;
  }
  [[nodiscard]] std::optional<std::size_t> frame_count() const override { return 7; }
  std::map<std::string, std::uint64_t> close() override {
    return {{"read", static_cast<std::uint64_t>(given_)}};
  }

 private:
  int count_;
  Duration step_;
  int failing_at_;
  int given_ = 0;
};

constexpr Duration kStep = std::chrono::milliseconds(5);
constexpr double kAsFastAsPossible = 0.0;

TEST(DatasetPlayer, GivesEverythingInOrderAndThenNothing) {
  DatasetPlayer player(std::make_unique<Samples>(1000, kStep), kAsFastAsPossible);
  for (int i = 1; i <= 1000; ++i) {
    const auto measurement = player.next({});
    ASSERT_TRUE(measurement.has_value());
    EXPECT_EQ(stamp_of(*measurement), Timestamp{kStep * i});
  }
  EXPECT_FALSE(player.next({}).has_value());
  EXPECT_EQ(player.frame_count(), 7U);
  EXPECT_EQ(player.close().at("read"), 1000U);
}

TEST(DatasetPlayer, RethrowsWhatTheRecordingThrowsAfterWhatCameBefore) {
  DatasetPlayer player(std::make_unique<Samples>(1000, kStep, 3), kAsFastAsPossible);
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(player.next({}).has_value());
  EXPECT_THROW(player.next({}), std::runtime_error);
}

TEST(DatasetPlayer, IsClosedWhileNobodyTakesWhatItHasRead) {
  DatasetPlayer player(std::make_unique<Samples>(1'000'000, kStep), kAsFastAsPossible);
  EXPECT_TRUE(player.next({}).has_value());
  EXPECT_LT(player.close().at("read"), 1000U);  // it does not read far ahead
}

TEST(DatasetPlayer, IsClosedWhileItWaitsForTheTimeOfTheNext) {
  DatasetPlayer player(std::make_unique<Samples>(3, std::chrono::hours(1)), 1.0);
  EXPECT_TRUE(player.next({}).has_value());
  EXPECT_LE(player.close().at("read"), 2U);
}

TEST(DatasetPlayer, GivesNothingOnceAStopIsRequested) {
  DatasetPlayer player(std::make_unique<Samples>(3, std::chrono::hours(1)), 1.0);
  EXPECT_TRUE(player.next({}).has_value());
  std::stop_source stop;
  stop.request_stop();
  EXPECT_FALSE(player.next(stop.get_token()).has_value());
}

}  // namespace
}  // namespace fleetloc
