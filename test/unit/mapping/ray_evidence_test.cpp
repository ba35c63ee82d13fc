#include "cloud/mapping/ray_evidence.hpp"

#include <optional>

#include <gmock/gmock.h>

#include "test/unit/mapping/yard.hpp"

namespace fleetloc {
namespace {

const Eigen::Vector3d kLidar(0.0, 0.0, 1.2);
const Eigen::Vector3d kBoard(5.0, 0.05, 1.2);  // middle of a board across the x axis
constexpr double kWallX = 10.0;

/// A board of 1 m width and height at x = 5 m, a wall behind it, level ground.
std::vector<Eigen::Vector3f> board_wall_and_ground() {
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 80; ++i) {
    for (int j = 0; j < 80; ++j) {
      const float u = 0.05F * static_cast<float>(i) + 0.02F;
      const float v = 0.05F * static_cast<float>(j) + 0.02F;
      points.emplace_back(static_cast<float>(kWallX) + 0.02F, u - 2.0F, v);
      points.emplace_back(4.0F * u, v - 2.0F, 0.02F);
      if (i < 20 && j < 20) points.emplace_back(5.02F, u - 0.5F, v + 0.7F);
    }
  }
  return points;
}

class RayEvidenceTest : public ::testing::Test {
 protected:
  RayEvidenceTest() { config_.scan_stride = 1; }

  /// So many scans of rays side by side in the board's middle that end at `x`.
  void cast_rays(int scans, double x) {
    for (int scan = 0; scan < scans; ++scan) {
      std::vector<LidarRay> rays;
      for (int offset = -4; offset <= 4; ++offset) {
        const double share = x / kBoard.x();
        rays.push_back(
            {.origin_map = kLidar,
             .p_map = {x + 0.02, share * (kBoard.y() + 0.02 * offset), kLidar.z() + 0.01 * share}});
      }
      evidence().add_scan(rays);
    }
  }

  RayEvidence& evidence() {
    if (!evidence_) evidence_.emplace(grid_, config_);
    return *evidence_;
  }

  [[nodiscard]] Verdict verdict_at(const Eigen::Vector3d& p_map) {
    return evidence().verdict(grid_.find(p_map).value());
  }
  [[nodiscard]] Verdict verdict_of_board() { return verdict_at({5.02, 0.05, 1.22}); }

  const EvidenceGrid grid_{board_wall_and_ground(), 0.2};
  EvidenceConfig config_ = default_mapping_config().evidence;

 private:
  std::optional<RayEvidence> evidence_;
};

TEST_F(RayEvidenceTest, KeepsWhatEverySessionHits) {
  for (int session = 0; session < 3; ++session) {
    cast_rays(5, 5.0);
    evidence().end_session();
  }
  EXPECT_EQ(verdict_of_board(), Verdict::kKept);
}

TEST_F(RayEvidenceTest, DropsWhatAnotherSessionSeesThrough) {
  cast_rays(50, 5.0);
  evidence().end_session();
  EXPECT_EQ(verdict_of_board(), Verdict::kKept);
  cast_rays(5, kWallX);
  evidence().end_session();
  EXPECT_EQ(verdict_of_board(), Verdict::kSeenThrough);
  EXPECT_EQ(verdict_at({10.02, 0.05, 1.22}), Verdict::kKept);  // where the rays end
}

TEST_F(RayEvidenceTest, IgnoresASessionThatHasNotObservedTheCell) {
  cast_rays(5, 5.0);
  evidence().end_session();
  for (int session = 0; session < 3; ++session) {
    cast_rays(5, 4.0);  // ends before the board
    evidence().end_session();
  }
  EXPECT_EQ(verdict_of_board(), Verdict::kKept);
}

TEST_F(RayEvidenceTest, DropsWhatTheSameSessionSeesThroughLater) {
  cast_rays(5, 5.0);
  cast_rays(95, kWallX);
  evidence().end_session();
  EXPECT_EQ(verdict_of_board(), Verdict::kSeenThrough);
}

TEST_F(RayEvidenceTest, KeepsWhatIsHitAsOftenAsItIsMissed) {
  for (int i = 0; i < 20; ++i) {
    cast_rays(1, 5.0);
    cast_rays(1, kWallX);
  }
  evidence().end_session();
  EXPECT_EQ(verdict_of_board(), Verdict::kKept);
}

TEST_F(RayEvidenceTest, RequiresAMinimumOfSessions) {
  config_.min_sessions = 2;
  cast_rays(5, 5.0);
  evidence().end_session();
  EXPECT_EQ(verdict_of_board(), Verdict::kUnconfirmed);
  cast_rays(5, 5.0);
  evidence().end_session();
  EXPECT_EQ(verdict_of_board(), Verdict::kKept);
}

TEST_F(RayEvidenceTest, OneOfManySessionsMayBeWrong) {
  for (int session = 0; session < 9; ++session) {
    cast_rays(5, 5.0);
    evidence().end_session();
  }
  cast_rays(5, kWallX);
  evidence().end_session();
  EXPECT_EQ(verdict_of_board(), Verdict::kKept);
}

TEST_F(RayEvidenceTest, KeepsGroundThatRaysGrazeOnTheirWayToTheWall) {
  // The rays meet the wall a hand's breadth above the ground, and pass over metres of it before.
  std::vector<LidarRay> rays;
  for (int i = -75; i < 75; ++i) {
    rays.push_back({.origin_map = kLidar, .p_map = {10.02, 0.02 * i, 0.05}});
  }
  for (int scan = 0; scan < 50; ++scan) evidence().add_scan(rays);
  evidence().end_session();
  for (int i = 0; i < 50; ++i) {
    const double x = 0.1 + 0.2 * i;
    EXPECT_EQ(verdict_at({x, 0.05, 0.02}), Verdict::kUnconfirmed) << x;  // nor hit, nor passed
  }
}

TEST_F(RayEvidenceTest, CountsMissesOnlyInEveryStrideOfScansAndWeighsThemSo) {
  config_.scan_stride = 10;
  cast_rays(5, 5.0);
  cast_rays(5, kWallX);  // not one of these is traced
  evidence().end_session();
  EXPECT_EQ(verdict_of_board(), Verdict::kKept);
  cast_rays(1, 5.0);
  cast_rays(40, kWallX);
  evidence().end_session();
  EXPECT_EQ(verdict_of_board(), Verdict::kSeenThrough);
}

}  // namespace
}  // namespace fleetloc
