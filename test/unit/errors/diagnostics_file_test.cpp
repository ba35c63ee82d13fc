#include "deploy/evaluation/errors/diagnostics_file.hpp"

#include <gmock/gmock.h>

#include "shared/config/delimited_file.hpp"
#include "test/unit/run_folder/written_run.hpp"

namespace fleetloc {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using ::testing::ThrowsMessage;
using DiagnosticsFile = RunFolderTest;

TEST_F(DiagnosticsFile, IsReadAsItWasWritten) {
  Matrix6d covariance = Matrix6d::Identity();
  covariance(0, 5) = covariance(5, 0) = 0.25;
  {
    RunFolder run(folder_);
    run.add_frame(frame(0.0, Quality::kInitializing));
    FrameRecord later = frame(1.5, Quality::kLocalized);
    later.pose.covariance_map = covariance;
    later.pose.covariance_odom = 2.0 * covariance;
    later.uplink_bytes = 1000;
    later.downlink_bytes = 200;
    later.loss = 0.125;
    later.round_trip = lasting(0.25);
    run.add_frame(later);
    run.add_frame(frame(2.0, Quality::kInitializing));
  }
  const auto frames = read_frame_diagnostics(folder_ / "diagnostics.csv");
  ASSERT_THAT(frames, SizeIs(3));
  EXPECT_EQ(frames[0].state, "initializing");
  EXPECT_EQ(frames[0].round_trip_s, std::nullopt);
  EXPECT_EQ(frames[1].stamp, at(1.5));
  EXPECT_EQ(frames[1].state, "localized");
  EXPECT_EQ(frames[1].uplink_bytes, 1000.0);
  EXPECT_EQ(frames[1].downlink_bytes, 200.0);
  EXPECT_EQ(frames[1].loss, 0.125);
  EXPECT_EQ(frames[1].round_trip_s, 0.25);

  const RunCovariances covariances = read_covariances(folder_ / "diagnostics.csv");
  ASSERT_THAT(covariances.map, SizeIs(1));
  EXPECT_EQ(covariances.map[0].stamp, at(1.5));
  EXPECT_EQ(covariances.map[0].covariance, covariance);
  ASSERT_THAT(covariances.odom, SizeIs(1));
  EXPECT_EQ(covariances.odom[0].covariance, 2.0 * covariance);
  EXPECT_EQ(covariances.frames, (std::vector<Timestamp>{at(1.5), at(2.0)}));
  EXPECT_EQ(covariances.localized, std::vector<Timestamp>{at(1.5)});
}

TEST_F(DiagnosticsFile, MayHoldNoFrames) {
  { const RunFolder run(folder_); }
  EXPECT_THAT(read_frame_diagnostics(folder_ / "diagnostics.csv"), IsEmpty());
}

TEST_F(DiagnosticsFile, NamesFileAndLineOfWhatIsWrong) {
  std::filesystem::create_directories(folder_);
  const auto file = folder_ / "diagnostics.csv";
  const auto expect_refused = [&file](const std::string& text, const std::string& why) {
    std::ofstream(file) << text;
    EXPECT_THAT([&] { read_frame_diagnostics(file); },
                ThrowsMessage<TextFileError>(HasSubstr(file.string() + why)));
  };
  const std::string header = "stamp_s,state,uplink_bytes,downlink_bytes,loss,round_trip_s\n";
  expect_refused("", ": has no header");
  expect_refused("stamp_s,state\n", ":1: there is no column 'uplink_bytes'");
  expect_refused(header + "1.0,lost,1,2,many,nan\n", ":2: ");
  expect_refused(header + "1.0,lost,1,2,0,nan\n1.0,lost,1,2,0,nan\n", ":3: the stamp");
  expect_refused(header + "1.0,lost,1,2,0\n", ":2: ");
}

}  // namespace
}  // namespace fleetloc
