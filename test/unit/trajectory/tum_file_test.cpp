#include "shared/trajectory/tum_file.hpp"

#include <fstream>
#include <sstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "shared/geometry/so3.hpp"
#include "test/test_folder.hpp"

namespace fleetloc {
namespace {

using ::testing::HasSubstr;

std::filesystem::path file_with(const std::string& name, const std::string& content) {
  const auto folder = test_folder() / "fleetloc_trajectory";
  std::filesystem::create_directories(folder);
  std::ofstream(folder / name) << content;
  return folder / name;
}

std::string error_of(const std::filesystem::path& file) {
  try {
    read_trajectory(file);
  } catch (const TrajectoryFileError& error) {
    return error.what();
  }
  return "no error";
}

TEST(TumFile, HasNineDecimals) {
  std::ostringstream text;
  const Timestamp stamp{Duration(1'403'636'580'038'555'648)};
  write_tum_line(
      text, stamp, {.R = Eigen::Quaterniond(0.5, -0.5, 0.5, 0.5), .p = {1.0, -2.5, 0.1}});
  EXPECT_EQ(text.str(),
            "1403636580.038555648 1.000000000 -2.500000000 0.100000000 "
            "-0.500000000 0.500000000 0.500000000 0.500000000\n");
}

TEST(TumFile, ReturnsWhatWasWritten) {
  std::ostringstream text;
  Trajectory trajectory;
  for (int i = 0; i < 20; ++i) {
    const std::int64_t later_ns = 7L * i;
    const StampedPose pose{
        .stamp = Timestamp(Duration(1'403'636'580'038'555'648 + later_ns)),
        .T_ref_body = {.R = exp_so3({0.3 * i, 0.1, -0.2}), .p = {0.1 * i, 1, 2}}};
    write_tum_line(text, pose.stamp, pose.T_ref_body);
    trajectory.push_back(pose);
  }
  const Trajectory read = read_trajectory(file_with("a.tum", "# a comment\n" + text.str()));
  ASSERT_EQ(read.size(), trajectory.size());
  for (std::size_t i = 0; i < read.size(); ++i) {
    EXPECT_EQ(read[i].stamp, trajectory[i].stamp);
    EXPECT_LT(local_coordinates(read[i].T_ref_body, trajectory[i].T_ref_body).norm(), 5e-9);
  }
}

TEST(TumFile, ReadsTheGroundTruthOfEuroc) {
  const auto file = file_with(
      "data.csv",
      "#timestamp,p_RS_R_x [m],...\r\n"
      "1403715273262142976,0.878895,2.1834,0.948427,0.069433,-0.824237,-0.106942,-0.551702,"
      "0.00157587,0.00179383,-0.00231615,-0.00224703,0.0215352,0.0770299,-0.0180115,0.0659796,"
      "0.0309774\r\n");
  const Trajectory read = read_trajectory(file);
  ASSERT_EQ(read.size(), 1U);
  EXPECT_EQ(read[0].stamp, Timestamp(Duration(1'403'715'273'262'142'976)));
  EXPECT_EQ(read[0].T_ref_body.p, Eigen::Vector3d(0.878895, 2.1834, 0.948427));
  EXPECT_NEAR(read[0].T_ref_body.R.w(), 0.069433, 1e-6);
  EXPECT_NEAR(read[0].T_ref_body.R.z(), -0.551702, 1e-6);
}

TEST(TumFile, IsEmptyWithoutPoses) {
  EXPECT_TRUE(read_trajectory(file_with("a.tum", "# nothing\n")).empty());
}

TEST(TumFile, NamesFileAndLineOfWhatIsWrong) {
  const std::string good = "1.5 0 0 0 0 0 0 1\n";
  EXPECT_THAT(error_of(file_with("a.tum", good + "1.4 0 0 0 0 0 0 1\n")),
              HasSubstr("a.tum:2: the stamp is not later"));
  EXPECT_THAT(error_of(file_with("a.tum", good + "1.6 0 0 0 0 0 1\n")),
              HasSubstr("a.tum:2: 7 columns instead of 8"));
  EXPECT_THAT(error_of(file_with("a.tum", good + "1.6 0 0 0 0 0 0 2\n")),
              HasSubstr("a.tum:2: the quaternion"));
  EXPECT_THAT(error_of(file_with("a.tum", good + "1.6 0 nan 0 0 0 0 1\n")), HasSubstr("a.tum:2: "));
  EXPECT_THAT(error_of(file_with("a.csv", "1,2,3\n")), HasSubstr("a.csv:1: fewer than 8 columns"));
  EXPECT_THAT(error_of("/nowhere/a.tum"), HasSubstr("/nowhere/a.tum: no such file"));
}

TEST(TumFile, OfARecordMayHaveStampsThatRepeatAndGoBack) {
  const auto file =
      file_with("jittering.tum", "2.0 1 0 0 0 0 0 1\n2.0 2 0 0 0 0 0 1\n1.5 3 0 0 0 0 0 1\n");
  const auto poses = read_poses_in_any_order(file);
  ASSERT_EQ(poses.size(), 3U);
  EXPECT_EQ(poses[1].stamp, poses[0].stamp);
  EXPECT_EQ(poses[2].T_ref_body.p.x(), 3.0);
  EXPECT_THAT(error_of(file), HasSubstr("not later"));
}

}  // namespace
}  // namespace fleetloc
