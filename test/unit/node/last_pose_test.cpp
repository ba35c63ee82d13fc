#include "robot/node/last_pose.hpp"

#include <fstream>

#include <gtest/gtest.h>

#include "test/test_folder.hpp"

namespace fleetloc {
namespace {

RobotOutput output_at(double x, Quality quality) {
  RobotOutput output;
  output.pose.emplace();
  output.pose->quality = quality;
  output.pose->T_map_body = Pose{.p = {x, 2.0, 3.0}};
  return output;
}

class LastPose : public testing::Test {
 protected:
  void keep(std::initializer_list<RobotOutput> outputs) const {
    LastPoseFile keeper(file_, "robot_1");
    for (const RobotOutput& output : outputs) keeper.add(output);
  }

  LastPose() { std::filesystem::remove(file_); }

  const std::filesystem::path file_ = test_folder() / "last_pose.yaml";
};

TEST_F(LastPose, IsTheNewestThatWasLocalized) {
  keep({output_at(1.0, Quality::kLocalized),
        output_at(1.01, Quality::kLocalized),  // has not moved
        output_at(4.0, Quality::kLocalized),
        output_at(9.0, Quality::kDeadReckoning),
        RobotOutput{}});
  const auto pose = read_last_pose(file_, "robot_1");
  ASSERT_TRUE(pose);
  EXPECT_EQ(pose->p, Eigen::Vector3d(4.0, 2.0, 3.0));
  keep({});
  EXPECT_TRUE(read_last_pose(file_, "robot_1")) << "a program without a pose leaves it";
}

TEST_F(LastPose, IsNoOtherRobotsAndNoneOfADamagedFile) {
  EXPECT_FALSE(read_last_pose(file_, "robot_1")) << "no file";
  keep({output_at(1.0, Quality::kLocalized)});
  EXPECT_FALSE(read_last_pose(file_, "robot_2"));
  for (const char* text :
       {"", "robot: robot_1\n", "robot: robot_1\nT_map_body: 1 2 3\n", "{[", "\x01"}) {
    std::ofstream(file_) << text;
    EXPECT_FALSE(read_last_pose(file_, "robot_1")) << text;
  }
}

TEST_F(LastPose, ThatCannotBeWrittenIsNotMissed) {
  LastPoseFile keeper(test_folder() / "no_such_folder" / "file", "robot_1");
  keeper.add(output_at(1.0, Quality::kLocalized));
}

}  // namespace
}  // namespace fleetloc
