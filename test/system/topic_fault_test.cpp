// fleetloc-play --faults and fleetloc-robot --sensors, in real time and with a localizer: what
// goes wrong with topics, one after the other in a single flight.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <ctime>
#include <fstream>
#include <iostream>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "test/system/checked_frames.hpp"
#include "test/system/live_fixture.hpp"

namespace fleetloc {
namespace {

using ::testing::Ge;

constexpr const char* kRobot = "robot_1";
constexpr const char* kDuration_s = "43";
constexpr std::chrono::seconds kBack{10};
constexpr std::chrono::seconds kForward{3600};
// Three: of a computer that was off without a battery, once it is told the time.
constexpr std::chrono::seconds kYears{94'608'000};
constexpr double kLastFaultEnds_s = 40.0;

/// A fault, and what the robot's log has to say of it.
struct TopicFault {
  double start_s;
  std::string fault;  ///< the rest, in the file's own words
  std::string named;  ///< without how far a clock was set: a stall at that moment is part of it
};

std::vector<TopicFault> topic_faults() {
  return {{5.0, "kind: non_finite_imu, duration_s: 0.3, share: 0.2", "/imu: messages are not used"},
          {7.0,
           "kind: zero_image_stamps, duration_s: 0.5",
           "/camera/left/image_raw: images have no stamps"},
          {9.0, "kind: zero_imu_stamps, duration_s: 0.2", "/imu: samples have no stamps"},
          {11.0,
           "kind: resized_images, duration_s: 1.5",
           "/camera/right/image_raw: images of 320x200 pixels are not used"},
          {15.0, "kind: clock_step, step_s: -10", "/imu: its clock was set back by "},
          {20.0, "kind: clock_step, step_s: 3600", "/imu: its clock was set forward by "},
          {25.0, "kind: clock_step, step_s: 94608000", "/imu: its clock was set forward by "},
          {30.0, "kind: imu_gap, duration_s: 1", "/imu: no message for"},
          {35.0, "kind: missing_left, duration_s: 5", "/camera/left/image_raw: no message for"}};
}

/// A line of a log, and when it was written [s]: "[2024-05-01 12:00:00.123] [info] ...".
struct LogLine {
  double time_s = 0.0;
  std::string text;
};

std::vector<LogLine> log_lines(const std::string& log) {
  std::vector<LogLine> lines;
  std::istringstream stream(log);
  for (std::string line; std::getline(stream, line);) {
    std::tm time{};
    const char* rest = strptime(line.c_str(), "[%Y-%m-%d %H:%M:%S", &time);
    if (rest == nullptr) continue;
    time.tm_isdst = -1;
    lines.push_back(
        {static_cast<double>(std::mktime(&time)) + std::stod(std::string("0") + rest), line});
  }
  return lines;
}

std::optional<double> first_time(const std::vector<LogLine>& log,
                                 const std::string& text,
                                 double from_s = 0.0) {
  for (const LogLine& line : log) {
    if (line.time_s >= from_s && line.text.find(text) != std::string::npos) return line.time_s;
  }
  return std::nullopt;
}

class TopicFaults : public LiveFixture {
 protected:
  void SetUp() override {
    if (kSanitized) GTEST_SKIP() << "sanitizers are too slow for real time";
    DdsFixture::SetUp();
    describe_sensors();
    std::ofstream plan(faults_);
    plan << "seed: 5\nfaults:\n";
    for (const TopicFault& one : topic_faults()) {
      plan << "  - {start_s: " << one.start_s << ", " << one.fault << "}\n";
    }
  }

  const std::filesystem::path faults_ = scratch_ / "faults.yaml";
};

TEST_F(TopicFaults, AreSurvivedNamedWithinTwoSecondsAndNeverMakeAPoseConfidentlyWrong) {
  ChildProgram localizer(FLEETLOC_CLOUD, cloud("localizer_1"));
  // All of the flight in one part of the run folder, also where a day passes by the robot's clock.
  const auto config = scratch_ / "one_part.yaml";
  std::ofstream(config) << "recording: {part_h: 0}\n";
  Arguments arguments = live_robot(kRobot);
  arguments.insert(arguments.end(), {"--config", config.string()});
  ChildProgram robot(FLEETLOC_ROBOT, arguments);
  const Outcome played = run(FLEETLOC_PLAY,
                             {flight_.folder.string(),
                              "--sensors",
                              sensors_.string(),
                              "--faults",
                              faults_.string(),
                              "--duration",
                              kDuration_s,
                              "--wait",
                              "60"});
  robot.signal(SIGTERM);
  const Outcome flown = robot.wait();
  ASSERT_EQ(played.exit_code, 0) << played.errors;
  ASSERT_EQ(flown.exit_code, 0) << flown.errors;

  const auto begin = first_time(log_lines(played.output), "playing");
  ASSERT_TRUE(begin) << played.output;
  const auto log = log_lines(flown.output);
  for (const TopicFault& fault : topic_faults()) {
    constexpr double kSlack = 0.2;  // of the player: its own start, and the frames' interval
    const double occurs_s = *begin + fault.start_s;
    const auto named = first_time(log, fault.named, occurs_s - kSlack);
    ASSERT_TRUE(named) << fault.named << '\n' << flown.output;
    std::cout << "named after " << *named - occurs_s << " s: " << fault.named << '\n';
    EXPECT_LE(*named - occurs_s, 2.0 + kSlack) << fault.named;
  }

  const auto frames = checked_frames(folder_of(kRobot), flight_, {-kBack, kForward, kYears});
  ASSERT_FALSE(frames.empty());
  std::cout << "worst while localized " << worst_while_localized(frames) << " m, in the end "
            << frames.back().state << '\n';
  const Duration in_flight = frames.back().stamp - first_frame(flight_.folder);
  EXPECT_THAT(to_seconds(in_flight), Ge(kLastFaultEnds_s + 1.0));  // it goes on after all of them
  const auto localized_between = [&](double begin_s, double end_s) {
    const auto first = std::ranges::find_if(frames, [&](const CheckedFrame& frame) {
      return to_seconds(frame.stamp - first_frame(flight_.folder)) > begin_s &&
             frame.state == "localized";
    });
    if (first == frames.end()) return false;
    const double time_s = to_seconds(first->stamp - first_frame(flight_.folder));
    std::cout << "after " << begin_s << " s localized at " << time_s << " s\n";
    return time_s < end_s;
  };
  EXPECT_TRUE(localized_between(13.0, 15.0));
  EXPECT_TRUE(localized_between(16.0, 20.0));
  EXPECT_TRUE(localized_between(21.0, 25.0));
  EXPECT_TRUE(localized_between(26.0, 30.0));
}

}  // namespace
}  // namespace fleetloc
