#include "robot/run_folder/run_summary.hpp"

#include <cstdint>

#include <gmock/gmock.h>

#include "test/unit/run_folder/written_run.hpp"

namespace fleetloc {
namespace {

using ::testing::DoubleNear;
using Summary = RunFolderTest;

constexpr double kNanosecond = 1e-9;  // [s]

TEST_F(Summary, HasEveryKeyEvenOfARunWithoutFrames) {
  RunFolder(folder_).finish({});
  const auto json = summary();
  for (const char* key : {"frames",
                          "keyframes",
                          "submaps_sent",
                          "answers_received",
                          "answers_applied",
                          "answers_rejected",
                          "corrections_applied",
                          "corrections_ignored",
                          "uplink_bytes",
                          "downlink_bytes",
                          "uplink_wire_bytes",
                          "downlink_wire_bytes",
                          "interrupted",
                          "duration_s",
                          "wall_s",
                          "cpu_s",
                          "cpu_ms_per_frame",
                          "decode_ms",
                          "tracking_ms",
                          "backend_ms",
                          "fusion_us_per_imu",
                          "first_pose_s",
                          "first_answer_s",
                          "first_localization_s",
                          "coverage",
                          "resets",
                          "standstill_s",
                          "max_rss_bytes"}) {
    EXPECT_TRUE(json.contains(key)) << key;
  }
  EXPECT_EQ(json.at("cpu_ms_per_frame"), 0.0);
  EXPECT_TRUE(json.at("first_pose_s").is_null());
  EXPECT_TRUE(json.at("first_answer_s").is_null());
  EXPECT_TRUE(json.at("first_localization_s").is_null());
  EXPECT_TRUE(json.at("coverage").is_null());
  EXPECT_TRUE(json.at("tracking_ms").at("p50").is_null());
}

TEST_F(Summary, TakesOverTheFiguresOfTheRun) {
  RunSummary figures;
  figures.keyframes = 11;
  figures.submaps_sent = 12;
  figures.corrections_applied = 13;
  figures.corrections_ignored = 14;
  figures.uplink_bytes = 15;
  figures.downlink_bytes = 16;
  figures.uplink_wire_bytes = 17;
  figures.downlink_wire_bytes = 18;
  figures.resets = 19;
  figures.standstill_s = 20.5;
  figures.max_rss_bytes = std::uint64_t{1} << 33U;
  figures.wall_s = 2.5;
  figures.cpu_s = 1.5;
  figures.fusion_us_per_imu = 7.5;
  figures.input_faults = {{"imu_gaps", 2}};
  RunFolder(folder_).finish(figures);
  const auto json = summary();
  EXPECT_EQ(json.at("keyframes"), 11);
  EXPECT_EQ(json.at("submaps_sent"), 12);
  EXPECT_EQ(json.at("corrections_applied"), 13);
  EXPECT_EQ(json.at("corrections_ignored"), 14);
  EXPECT_EQ(json.at("uplink_bytes"), 15);
  EXPECT_EQ(json.at("downlink_bytes"), 16);
  EXPECT_EQ(json.at("uplink_wire_bytes"), 17);
  EXPECT_EQ(json.at("downlink_wire_bytes"), 18);
  EXPECT_EQ(json.at("resets"), 19);
  EXPECT_EQ(json.at("standstill_s"), 20.5);
  EXPECT_EQ(json.at("max_rss_bytes"), std::uint64_t{1} << 33U);
  EXPECT_EQ(json.at("wall_s"), 2.5);
  EXPECT_EQ(json.at("cpu_s"), 1.5);
  EXPECT_EQ(json.at("fusion_us_per_imu"), 7.5);
  EXPECT_EQ(json.at("input_faults").at("imu_gaps"), 2);
}

TEST_F(Summary, CountsTimesFromTheFirstFrame) {
  RunFolder run(folder_);
  run.add_frame(frame(10.0, Quality::kInitializing));
  run.add_frame(
      {.pose = pose_estimate(11.5, Quality::kLost, 0.0, false), .round_trip = std::nullopt});
  for (const double arrival_s : {12.0, 12.5}) {
    AnswerRecord refused = answer(LocalizationStatus::kTooFewMatches, "");
    refused.arrival = at(arrival_s);
    run.add_answer(refused);
  }
  run.add_frame(frame(13.0, Quality::kLocalized));
  run.add_frame(frame(14.0, Quality::kLocalized));
  run.finish({});
  const auto json = summary();
  EXPECT_EQ(json.at("frames"), 4);
  EXPECT_THAT(json.at("first_answer_s").get<double>(), DoubleNear(2.0, kNanosecond));
  EXPECT_THAT(json.at("duration_s").get<double>(), DoubleNear(4.0, kNanosecond));
  EXPECT_THAT(json.at("first_pose_s").get<double>(), DoubleNear(1.5, kNanosecond));
  EXPECT_THAT(json.at("first_localization_s").get<double>(), DoubleNear(3.0, kNanosecond));
}

TEST_F(Summary, CoversFramesThatAreLocalizedOrDeadReckonedForLessThanFiveSeconds) {
  RunFolder run(folder_);
  run.add_frame(frame(0.0, Quality::kInitializing));  // before the first pose: not counted
  run.add_frame(frame(1.0, Quality::kLost));
  run.add_frame(frame(2.0, Quality::kLocalized));
  run.add_frame(frame(3.0, Quality::kLocalized, 60.0));  // localized is localized
  run.add_frame(frame(4.0, Quality::kDeadReckoning, 4.999));
  run.add_frame(frame(5.0, Quality::kDeadReckoning, 5.0));
  run.finish({});
  EXPECT_DOUBLE_EQ(summary().at("coverage").get<double>(), 3.0 / 5.0);
}

TEST_F(Summary, CountsAnswersByReason) {
  RunFolder run(folder_);
  run.add_answer(answer(LocalizationStatus::kLocalized, ""));
  run.add_answer(answer(LocalizationStatus::kLocalized, ""));
  run.add_answer(answer(LocalizationStatus::kLocalized, "gated"));
  run.add_answer(answer(LocalizationStatus::kPoorFit, ""));
  run.add_answer(answer(LocalizationStatus::kPoorFit, ""));
  run.finish({});
  const auto json = summary();
  EXPECT_EQ(json.at("answers_received"), 5);
  EXPECT_EQ(json.at("answers_applied"), 2);
  EXPECT_EQ(json.at("answers_rejected"), (nlohmann::json{{"gated", 1}, {"poor_fit", 2}}));
}

TEST_F(Summary, CountsTrackingAndBackEndAsTimePerFrame) {
  RunFolder run(folder_);
  for (int i = 0; i < 4; ++i) run.add_frame(frame(0.05 * i, Quality::kLocalized));
  RunSummary figures;
  figures.decode_ms.add(100.0);  // is no part of it
  for (const double ms : {1.0, 2.0, 3.0, 4.0}) figures.tracking_ms.add(ms);
  figures.backend_ms.add(6.0);
  run.finish(figures);
  const auto json = summary();
  EXPECT_DOUBLE_EQ(json.at("cpu_ms_per_frame").get<double>(), (1.0 + 2.0 + 3.0 + 4.0 + 6.0) / 4.0);
  EXPECT_EQ(json.at("backend_ms"), (nlohmann::json{{"p50", 6.0}, {"p99", 6.0}}));
  EXPECT_EQ(json.at("tracking_ms").at("p99"), 4.0);
  EXPECT_EQ(json.at("decode_ms").at("p50"), 100.0);
}

}  // namespace
}  // namespace fleetloc
