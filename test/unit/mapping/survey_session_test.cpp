#include "cloud/mapping/survey_session.hpp"

#include <gmock/gmock.h>

#include "shared/geometry/so3.hpp"
#include "test/test_folder.hpp"
#include "test/unit/mapping/yard.hpp"

namespace fleetloc {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr Duration kMaxGap = std::chrono::milliseconds(200);

/// Drives and turns by several degrees and a decimetre in one scan.
SplineMotion turning() {
  return spline_through(grid_over(4.0, 0.05), [](double t) {
    return Pose{.R = exp_so3({0.02, -0.01, 0.9 * t}), .p = {1.5 * t - 3.0, 0.4 * t, 0.9}};
  });
}

Trajectory poses_of(const SplineMotion& motion, double rate_hz) {
  Trajectory poses;
  for (int i = 0; i <= static_cast<int>(motion.duration() * rate_hz); ++i) {
    const Duration after = from_seconds(i / rate_hz);
    poses.push_back(
        {.stamp = kSurveyStart + after, .T_ref_body = motion.at(to_seconds(after)).T_map_body});
  }
  return poses;
}

/// Greatest distance of points at the wall's height from the wall's plane.
double off_the_wall(const std::vector<LidarRay>& rays) {
  double most = 0.0;
  int on_wall = 0;
  for (const LidarRay& ray : rays) {
    const Eigen::Vector3d& p = ray.p_map;
    if (std::abs(p.x()) > 8.0 || p.y() < 5.0 || p.z() < 0.5) continue;
    most = std::max(most, std::abs(p.y() - static_cast<double>(Yard::kWallY)));
    ++on_wall;
  }
  EXPECT_GT(on_wall, 200);
  return most;
}

TEST(SurveySession, TakesTheMotionOutOfAScanThatTurns) {
  LidarConfig config = survey_lidar();
  config.range_sigma_m = 0.0;
  const Lidar lidar(config, 1);
  const SplineMotion motion = turning();
  const LidarScan scan = lidar.scan(Yard().caster(), motion, kSurveyStart, 15);
  const Trajectory poses = poses_of(motion, 100.0);
  const auto rays = deskewed(scan, config.calibration, poses, kMaxGap);
  ASSERT_TRUE(rays);
  ASSERT_EQ(rays->size(), scan.points.size());
  EXPECT_LT(off_the_wall(*rays), 0.002);

  const Pose start = interpolate(poses, scan.stamp, kMaxGap).value();
  const Trajectory frozen{{kSurveyStart, start}, {kSurveyStart + from_seconds(4.0), start}};
  const auto smeared = deskewed(scan, config.calibration, frozen, std::chrono::seconds(10));
  ASSERT_TRUE(smeared);
  EXPECT_GT(off_the_wall(*smeared), 0.1);
}

TEST(SurveySession, KnowsWhereTheLidarWas) {
  const LidarConfig config = survey_lidar();
  const SplineMotion motion = turning();
  const LidarScan scan = Lidar(config, 1).scan(Yard().caster(), motion, kSurveyStart, 15);
  const auto rays = deskewed(scan, config.calibration, poses_of(motion, 100.0), kMaxGap);
  ASSERT_TRUE(rays);
  const std::size_t last = scan.points.size() - 1;
  const double time_s = 1.5 + config.calibration.column_time_s(scan.points[last].column);
  const Pose truth = motion.at(time_s).T_map_body * config.calibration.T_body_lidar;
  EXPECT_LT(((*rays)[last].origin_map - truth.p).norm(), 1e-3);
}

TEST(SurveySession, HasNoPlaceForAScanThatThePosesDoNotCover) {
  const LidarConfig config = survey_lidar();
  const SplineMotion motion = turning();
  const Trajectory poses = poses_of(motion, 100.0);
  LidarScan scan = Lidar(config, 1).scan(Yard().caster(), motion, kSurveyStart, 15);
  const Trajectory late(poses.begin() + 155, poses.end());  // begins within the scan
  EXPECT_FALSE(deskewed(scan, config.calibration, late, kMaxGap));
  const Trajectory early(poses.begin(), poses.begin() + 155);
  EXPECT_FALSE(deskewed(scan, config.calibration, early, kMaxGap));
  Trajectory with_gap = poses;
  with_gap.erase(with_gap.begin() + 140, with_gap.begin() + 170);
  EXPECT_FALSE(deskewed(scan, config.calibration, with_gap, kMaxGap));
  scan.points.clear();
  EXPECT_FALSE(deskewed(scan, config.calibration, late, kMaxGap));
}

class SurveyFolder : public ::testing::Test {
 protected:
  void SetUp() override {
    written_survey(folder_, 1, [yard = Yard().caster()](double) { return yard; });
  }

  void expect_refused(const std::string& message) const {
    EXPECT_THAT([this] { const SurveySession session(folder_, kMaxGap); },
                ThrowsMessage<DatasetError>(HasSubstr(message)));
  }

  const std::filesystem::path folder_ = test_folder() / "survey";
  const std::filesystem::path poses_ = folder_ / "mav0" / "state_groundtruth_estimate0";
};

TEST_F(SurveyFolder, IsReadScanByScan) {
  const SurveySession session(folder_, kMaxGap);
  ASSERT_EQ(session.scans(), 80U);
  const auto rays = session.scan(7);
  ASSERT_TRUE(rays);
  EXPECT_GT(rays->size(), 5000U);
}

TEST_F(SurveyFolder, NeedsALidar) {
  std::filesystem::remove_all(folder_ / "mav0" / "lidar0");
  expect_refused((folder_ / "mav0" / "lidar0").string() + ": missing");
}

TEST_F(SurveyFolder, NeedsScans) {
  std::ofstream(folder_ / "mav0" / "lidar0" / "data.csv") << "#timestamp [ns],filename\n";
  expect_refused("lidar0/data.csv: lists no scan");
}

TEST_F(SurveyFolder, NeedsPoses) {
  std::filesystem::remove(poses_ / "data.tum");
  expect_refused(poses_.string() + ": neither data.csv nor data.tum");
}

TEST_F(SurveyFolder, NamesTheLineOfAPoseThatIsWrong) {
  std::ofstream(poses_ / "data.tum") << "1000 0 0 0 0 0 0 1\n1001 0 0 zero 0 0 0 1\n";
  expect_refused((poses_ / "data.tum").string() + ":2");
  std::ofstream(poses_ / "data.csv") << "#timestamp\n";  // wins over data.tum
  expect_refused((poses_ / "data.csv").string() + ": holds no pose");
}

}  // namespace
}  // namespace fleetloc
