#include <stdexcept>

#include <gmock/gmock.h>

#include "robot/run_folder/run_recorder.hpp"
#include "test/unit/run_folder/written_run.hpp"

namespace fleetloc {
namespace {

using ::testing::AllOf;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using ::testing::StartsWith;

constexpr std::size_t kTriangle = 21;  // entries on and above the diagonal of 6 x 6

constexpr const char* kDiagnosticsHeader =
    "stamp_s,state,since_last_answer_s,"
    "cm11,cm12,cm13,cm14,cm15,cm16,cm22,cm23,cm24,cm25,cm26,cm33,cm34,cm35,cm36,cm44,cm45,cm46,"
    "cm55,cm56,cm66,"
    "co11,co12,co13,co14,co15,co16,co22,co23,co24,co25,co26,co33,co34,co35,co36,co44,co45,co46,"
    "co55,co56,co66,"
    "uplink_bytes,downlink_bytes,loss,round_trip_s,tracks,keyframe,resets";

constexpr const char* kAnswersHeader =
    "stamp_s,arrival_s,localizer,status,reason,applied,innovation_m,innovation_deg,places";

TEST_F(RunFolderTest, MakesTheFolderAndNamesTheColumns) {
  RunFolder(folder_ / "deep" / "run").finish({});
  EXPECT_THAT(lines_of(folder_ / "deep" / "run" / "diagnostics.csv"),
              ElementsAre(kDiagnosticsHeader));
  EXPECT_THAT(lines_of(folder_ / "deep" / "run" / "answers.csv"), ElementsAre(kAnswersHeader));
}

TEST_F(RunFolderTest, WritesAsManyFieldsAsColumns) {
  RunFolder run(folder_);
  FrameRecord record = frame(0.05, Quality::kLocalized, 0.5);
  record.pose.covariance_map = Matrix6d::Identity();
  record.pose.covariance_map(0, 5) = record.pose.covariance_map(5, 0) = 0.25;
  record.pose.covariance_odom = 4.0 * Matrix6d::Identity();
  record.uplink_bytes = 1000;
  record.downlink_bytes = 200;
  record.loss = 0.125;
  record.round_trip = lasting(0.25);
  record.tracks = 150;
  record.keyframe = true;
  record.resets = 2;
  run.add_frame(record);
  run.finish({});

  const auto fields = fields_of(lines_of(folder_ / "diagnostics.csv").at(1), ',');
  ASSERT_THAT(fields, SizeIs(fields_of(kDiagnosticsHeader, ',').size()));
  EXPECT_EQ(fields[0], "1403715274.050000000");
  EXPECT_EQ(fields[1], "localized");
  EXPECT_EQ(std::stod(fields[2]), 0.5);
  EXPECT_EQ(std::stod(fields[3]), 1.0);              // cm11
  EXPECT_EQ(std::stod(fields[8]), 0.25);             // cm16
  EXPECT_EQ(std::stod(fields[3 + kTriangle]), 4.0);  // co11
  const std::vector<std::string> last(fields.end() - 7, fields.end());
  EXPECT_THAT(last, ElementsAre("1000", "200", "0.1250", "0.250000", "150", "1", "2"));
}

TEST_F(RunFolderTest, WritesNoNumberForWhatIsNotKnownYet) {
  RunFolder run(folder_);
  run.add_frame(frame(0.0, Quality::kInitializing));
  run.finish({});
  const auto fields = fields_of(lines_of(folder_ / "diagnostics.csv").at(1), ',');
  const std::vector<std::string> covariances(fields.begin() + 3,
                                             fields.begin() + 3 + 2 * kTriangle);
  EXPECT_THAT(covariances, Each("nan"));
  EXPECT_EQ(fields[fields.size() - 4], "nan");  // round_trip_s
}

TEST_F(RunFolderTest, WritesOdometryFromTheFirstPoseOn) {
  RunFolder run(folder_);
  run.add_frame(frame(0.0, Quality::kInitializing));
  FrameRecord lost = frame(0.05, Quality::kLost);
  lost.pose.T_map_body.reset();
  run.add_frame(lost);
  run.add_frame(frame(0.1, Quality::kLocalized));
  run.finish({});
  EXPECT_THAT(lines_of(folder_ / "odometry.tum"),
              ElementsAre("1403715274.050000000 0.050000000 0.000000000 0.000000000 0.000000000 "
                          "0.000000000 0.000000000 1.000000000",
                          StartsWith("1403715274.100000000 0.1")));
  EXPECT_THAT(lines_of(folder_ / "diagnostics.csv"), SizeIs(1 + 3));
}

TEST_F(RunFolderTest, WritesMapPosesFromTheFirstLocalizationOn) {
  RunFolder run(folder_);
  const PoseEstimate before = pose_estimate(0.005, Quality::kLost, 0.0, false);
  run.add_imu_rate_pose(before);
  run.add_frame({.pose = before, .round_trip = std::nullopt});
  run.add_imu_rate_pose(pose_estimate(0.010, Quality::kLocalized));
  run.add_imu_rate_pose(pose_estimate(0.015, Quality::kDeadReckoning));
  run.add_frame(frame(0.015, Quality::kDeadReckoning));
  run.finish({});
  EXPECT_THAT(lines_of(folder_ / "localization.tum"),
              ElementsAre(StartsWith("1403715274.010000000 0.000000000 0.010000000 "),
                          StartsWith("1403715274.015000000 0.000000000 0.015000000 ")));
  EXPECT_THAT(lines_of(folder_ / "localization_frames.tum"),
              ElementsAre(StartsWith("1403715274.015000000 ")));
}

TEST_F(RunFolderTest, WritesWhatBecameOfEachAnswer) {
  RunFolder run(folder_);
  AnswerRecord applied = answer(LocalizationStatus::kLocalized, "");
  applied.innovation = Vector6d{0.0, 0.0, 0.01, 0.3, 0.0, 0.4};
  run.add_answer(applied);
  run.add_answer(answer(LocalizationStatus::kLocalized, "gated"));
  AnswerRecord ambiguous = answer(LocalizationStatus::kAmbiguous, "");
  ambiguous.places = 3;
  run.add_answer(ambiguous);
  run.finish({});
  const auto lines = lines_of(folder_ / "answers.csv");
  EXPECT_THAT(
      lines,
      ElementsAre(
          kAnswersHeader,
          "1403715275.000000000,1403715275.250000000,localizer_1,localized,,1,0.5000,0.5730,0",
          "1403715275.000000000,1403715275.250000000,localizer_1,localized,gated,0,nan,nan,0",
          "1403715275.000000000,1403715275.250000000,localizer_1,ambiguous,,0,nan,nan,3"));
}

TEST_F(RunFolderTest, KeepsTheConfiguration) {
  const RunFolder run(folder_);
  run.write_config("# fleetloc-replay\nvio: {window: {keyframes: 10}}\n");
  EXPECT_THAT(lines_of(folder_ / "config.yaml"),
              ElementsAre("# fleetloc-replay", "vio: {window: {keyframes: 10}}"));
}

TEST_F(RunFolderTest, KeepsWhatWasAddedIfTheRunEndsEarly) {
  {
    RunFolder run(folder_);
    for (int i = 0; i < 100; ++i) {
      run.add_imu_rate_pose(pose_estimate(0.05 * i, Quality::kLocalized));
      run.add_frame(frame(0.05 * i, Quality::kLocalized));
    }
    run.add_answer(answer(LocalizationStatus::kLocalized, ""));
  }
  EXPECT_THAT(lines_of(folder_ / "odometry.tum"), SizeIs(100));
  EXPECT_THAT(lines_of(folder_ / "localization.tum"), SizeIs(100));
  EXPECT_THAT(lines_of(folder_ / "localization_frames.tum"), SizeIs(100));
  EXPECT_THAT(lines_of(folder_ / "diagnostics.csv"), SizeIs(1 + 100));
  EXPECT_THAT(lines_of(folder_ / "answers.csv"), SizeIs(1 + 1));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "summary.json"));  // it would claim a whole run
}

TEST_F(RunFolderTest, StartsAnewWhereAnEarlierRunWas) {
  {
    RunFolder run(folder_);
    run.add_frame(frame(0.0, Quality::kLocalized));
    run.finish({});
  }
  RunFolder(folder_).finish({});
  EXPECT_THAT(lines_of(folder_ / "odometry.tum"), IsEmpty());
  EXPECT_EQ(summary().at("frames"), 0);
}

TEST_F(RunFolderTest, KeepsNoSummaryOfAnEarlierRun) {
  RunFolder(folder_).finish({});
  const RunFolder killed(folder_);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "summary.json"));
}

TEST_F(RunFolderTest, ContinuesTheNumbersOfAnEarlierRunsParts) {
  std::filesystem::create_directories(folder_ / "part_000041");
  std::filesystem::create_directories(folder_ / "part_of_mine");
  RunFolder run(folder_, {.kept = 1});
  run.begin_part();
  run.finish({});
  EXPECT_TRUE(std::filesystem::exists(folder_ / "part_000042" / "answers.csv"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "part_000041")) << "one is kept";
  EXPECT_TRUE(std::filesystem::exists(folder_ / "part_of_mine"));
}

template <typename Action>
std::string error_of(Action action) {
  try {
    action();
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "no error";
}

TEST_F(RunFolderTest, NamesAFolderThatCannotBeMade) {
  std::filesystem::create_directories(folder_);
  std::ofstream(folder_ / "file") << "not a folder";
  const auto inside = folder_ / "file" / "run";
  EXPECT_THAT(error_of([&] { RunFolder run(inside); }), HasSubstr(inside.string()));
}

TEST_F(RunFolderTest, NamesAFileThatCannotBeWritten) {
  std::filesystem::create_directories(folder_ / "diagnostics.csv");
  EXPECT_THAT(error_of([&] { RunFolder run(folder_); }),
              AllOf(HasSubstr((folder_ / "diagnostics.csv").string()), HasSubstr("written")));
}

TEST_F(RunFolderTest, NamesASummaryThatCannotBeWritten) {
  RunFolder run(folder_);
  std::filesystem::create_directories(folder_ / "summary.json");
  EXPECT_THAT(error_of([&] { run.finish({}); }), HasSubstr((folder_ / "summary.json").string()));
}

TEST_F(RunFolderTest, IsOfOneProgramAtATime) {
  {
    const RunFolder run(folder_);
    EXPECT_THAT(error_of([&] { RunFolder second(folder_); }),
                AllOf(HasSubstr(folder_.string()), HasSubstr("another program")));
  }
  EXPECT_EQ(error_of([&] { RunFolder next(folder_); }), "no error");
}

TEST_F(RunFolderTest, SaysAtOnceThatTheDiskIsFull) {
  std::filesystem::create_directories(folder_);
  std::filesystem::create_symlink("/dev/full", folder_ / "diagnostics.csv");
  RunFolder run(folder_);
  const auto names_it = AllOf(HasSubstr((folder_ / "diagnostics.csv").string()), HasSubstr("full"));
  EXPECT_THAT(error_of([&] { run.add_frame(frame(0.0, Quality::kLocalized)); }), names_it);
  EXPECT_THAT(error_of([&] { run.finish({}); }), names_it);
  EXPECT_EQ(summary().at("frames"), 1) << "what was written is kept";
}

TEST_F(RunFolderTest, AFullDiskEndsTheRecordingAndNotTheRobot) {
  std::filesystem::create_directories(folder_);
  std::filesystem::create_symlink("/dev/full", folder_ / "odometry.tum");
  RunRecorder recorder(folder_);
  const RobotOutput output{
      .pose = std::nullopt,
      .frames = {{.stamp = at(0.0), .pose = pose_estimate(0.0, Quality::kLocalized)}},
      .answers = {},
      .traffic = {}};
  for (int i = 0; i < 3; ++i) EXPECT_NO_THROW(recorder.add(output));
  EXPECT_EQ(recorder.faults().at("unwritten_outputs"), 3);
}

TEST_F(RunFolderTest, GoesOnInANewPartAfterATimeAndDeletesTheOldest) {
  RunFolder run(folder_, {.max_time = lasting(10.0), .kept = 2});
  for (int second = 0; second < 36; ++second) run.add_frame(frame(second, Quality::kLocalized));
  run.finish({});
  EXPECT_FALSE(std::filesystem::exists(folder_ / "part_000001"));
  const auto third = lines_of(folder_ / "part_000003" / "diagnostics.csv");
  ASSERT_THAT(third, SizeIs(1 + 11));
  EXPECT_EQ(third.front(), kDiagnosticsHeader);
  EXPECT_THAT(third.at(1), StartsWith("1403715296.0")) << "22 s";
  EXPECT_THAT(lines_of(folder_ / "part_000003" / "localization_frames.tum"), SizeIs(11));
  EXPECT_THAT(lines_of(folder_ / "diagnostics.csv"), SizeIs(1 + 3));
  EXPECT_EQ(summary().at("frames"), 36) << "of all parts";
}

TEST_F(RunFolderTest, GoesOnInANewPartWhenItsFilesAreLarge) {
  RunFolder run(folder_, {.max_bytes = 20'000, .kept = 1000});
  for (int i = 0; i < 300; ++i) {
    run.add_imu_rate_pose(pose_estimate(i, Quality::kLocalized));
    run.add_frame(frame(i, Quality::kLocalized));
  }
  ASSERT_TRUE(std::filesystem::exists(folder_ / "part_000002"));
  std::uintmax_t bytes = 0;
  for (const auto& file : std::filesystem::directory_iterator(folder_ / "part_000001")) {
    bytes += file.file_size();
  }
  EXPECT_GE(bytes, 20'000);
  EXPECT_LT(bytes, 22'000);
}

TEST_F(RunFolderTest, GoesOnInANewPartWhenAsked) {
  RunFolder run(folder_);
  run.add_frame(frame(1.0, Quality::kLocalized));
  run.begin_part();
  run.add_frame(frame(2.0, Quality::kLocalized));
  run.finish({});
  EXPECT_THAT(lines_of(folder_ / "part_000001" / "diagnostics.csv"), SizeIs(2));
  EXPECT_THAT(lines_of(folder_ / "diagnostics.csv"), SizeIs(2));
}

}  // namespace
}  // namespace fleetloc
