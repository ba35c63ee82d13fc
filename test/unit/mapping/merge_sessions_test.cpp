#include "cloud/mapping/merge_sessions.hpp"

#include <algorithm>
#include <map>

#include <gmock/gmock.h>

#include "test/test_folder.hpp"
#include "test/unit/mapping/yard.hpp"

namespace fleetloc {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

const Eigen::Vector3f kCarCenter(3.0F, -4.0F, 0.75F);
const Eigen::Vector3f kCarHalf(2.0F, 0.9F, 0.75F);
const Eigen::Vector3f kPersonHalf(0.2F, 0.2F, 0.85F);

RayCaster yard_with_car() {
  Yard yard;
  yard.add_box(kCarCenter, kCarHalf);
  return yard.caster();
}

/// Walks along the wall, across the robot's view.
Eigen::Vector3f person_at(double time_s) {
  return {static_cast<float>(5.6 - 1.4 * time_s), 3.0F, 0.85F};
}

RayCaster yard_with_person(double time_s) {
  Yard yard;
  yard.add_box(person_at(time_s), kPersonHalf);
  return yard.caster();
}

RayCaster empty_yard(double /*time_s*/) {
  return Yard().caster();
}

/// Points in an upright box that stands clear of ground and wall.
long count_in(const std::vector<Eigen::Vector3f>& points,
              const Eigen::Vector3f& center,
              const Eigen::Vector3f& half) {
  return std::ranges::count_if(points, [&](const Eigen::Vector3f& p) {
    return p.z() > 0.25F && ((p - center).cwiseAbs() - half).maxCoeff() < 0.1F;
  });
}

/// Surveys in folders of their own; made once.
class MergeSessions : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    written_survey(folder("car"), 1, [yard = yard_with_car()](double) { return yard; });
    written_survey(folder("person"), 2, yard_with_person);
    written_survey(folder("empty"), 3, empty_yard);
  }

  static std::filesystem::path folder(const std::string& name) { return test_folder() / name; }

  static MergedSessions merged(const std::vector<std::string>& names,
                               const MappingConfig& config = default_mapping_config()) {
    std::vector<SurveySession> sessions;
    sessions.reserve(names.size());
    for (const std::string& name : names) sessions.emplace_back(folder(name), config.max_gap);
    return merge_sessions(sessions, config);
  }

  /// Without any evidence: what is measured at all.
  static MergedSessions unfiltered(const std::vector<std::string>& names) {
    MappingConfig config = default_mapping_config();
    config.evidence.min_agreement = 0.0;
    config.evidence.min_hit_share = 0.0;
    return merged(names, config);
  }
};

long pole(const MergedSessions& merged) {
  return count_in(merged.points_map,
                  Yard::kPole + Eigen::Vector3f(0.0F, 0.0F, 1.5F),
                  {Yard::kPoleHalfWidth, Yard::kPoleHalfWidth, 1.5F});
}

long ground(const MergedSessions& merged) {
  return std::ranges::count_if(merged.points_map,
                               [](const Eigen::Vector3f& p) { return std::abs(p.z()) < 0.1F; });
}

long wall(const MergedSessions& merged) {
  return std::ranges::count_if(merged.points_map, [](const Eigen::Vector3f& p) {
    return std::abs(p.y() - Yard::kWallY) < 0.1F && p.z() > 0.2F;
  });
}

TEST_F(MergeSessions, DropsACarThatTheNextSessionDoesNotFind) {
  const MergedSessions alone = merged({"car"});
  const long car = count_in(alone.points_map, kCarCenter, kCarHalf);
  ASSERT_GT(car, 500);
  const MergedSessions both = merged({"car", "empty"});
  EXPECT_LT(count_in(both.points_map, kCarCenter, kCarHalf), car / 10);
  EXPECT_GT(both.report.seen_through, static_cast<std::size_t>(car) * 8 / 10);
}

TEST_F(MergeSessions, DropsAWalkerInASingleSession) {
  const auto trail = [](const MergedSessions& result) {  // that is in view before and after
    return count_in(result.points_map, {0.0F, 3.0F, 0.85F}, {2.0F, 0.2F, 0.85F});
  };
  const long walker = trail(unfiltered({"person"}));
  ASSERT_GT(walker, 500);
  EXPECT_LT(trail(merged({"person"})), walker / 10);
}

TEST_F(MergeSessions, KeepsPoleGroundAndWall) {
  const std::vector<std::string> all{"car", "person", "empty"};
  const MergedSessions filtered = merged(all);
  const MergedSessions everything = unfiltered(all);
  EXPECT_GT(pole(everything), 50);
  EXPECT_GE(pole(filtered), pole(everything) * 98 / 100);
  EXPECT_GT(ground(everything), 10000);
  EXPECT_GE(ground(filtered), ground(everything) * 995 / 1000);
  EXPECT_GT(wall(everything), 5000);
  EXPECT_GE(wall(filtered), wall(everything) * 995 / 1000);
}

TEST_F(MergeSessions, AccountsForEveryPoint) {
  const MergedSessions result = merged({"car", "empty"});
  const MergeReport& report = result.report;
  ASSERT_EQ(report.sessions.size(), 2U);
  const SurveySession session(folder("car"), std::chrono::milliseconds(200));
  std::size_t points = 0;
  for (std::size_t i = 0; i < session.scans(); ++i) points += session.scan(i).value().size();
  EXPECT_EQ(report.sessions[0].dataset, folder("car"));
  EXPECT_EQ(report.sessions[0].scans, 80U);
  EXPECT_EQ(report.sessions[0].points, points);
  EXPECT_EQ(report.kept, result.points_map.size());
  EXPECT_EQ(report.merged, report.kept + report.seen_through + report.unconfirmed);
  auto text = ConfigReader::from_string(report_text(report));
  EXPECT_EQ(text.get<std::size_t>("kept"), report.kept);
}

TEST_F(MergeSessions, LeavesOutPointsThatAreTooNearOrTooFar) {
  MappingConfig config = default_mapping_config();
  config.min_range_m = 6.0;
  config.max_range_m = 9.0;
  const MergedSessions result = merged({"empty"}, config);
  const SessionCounts& counts = result.report.sessions.front();
  EXPECT_GT(counts.too_near, 1000U);
  EXPECT_GT(counts.too_far, 1000U);
  EXPECT_LT(counts.too_near + counts.too_far, counts.points);
  for (const Eigen::Vector3f& p : result.points_map) EXPECT_LT(p.head<2>().norm(), 4.0F + 9.1F);
}

TEST_F(MergeSessions, LeavesOutAndCountsScansBeyondThePoses) {
  const auto short_record = folder("short");
  std::filesystem::remove_all(short_record);
  std::filesystem::copy(folder("empty"), short_record, std::filesystem::copy_options::recursive);
  const auto file = short_record / "mav0" / "state_groundtruth_estimate0" / "data.tum";
  const auto write = [&](double from_s, double to_s) {
    std::ofstream tum(file);
    for (int i = 0; from_s + 0.1 * i <= to_s; ++i) {
      const double t = from_s + 0.1 * i;
      write_tum_line(tum, kSurveyStart + from_seconds(t), pose_in_yard(t));
    }
  };
  write(0.95, 2.06);
  const MergedSessions result = merged({"short"});
  EXPECT_EQ(result.report.sessions.front().scans, 80U);
  EXPECT_EQ(result.report.sessions.front().scans_without_pose, 70U);
  write(100.0, 101.0);
  EXPECT_THAT(
      [] {
        static_cast<void>(merged({"empty", "short"}));
      },
      ThrowsMessage<DatasetError>(HasSubstr("short/mav0: no scan lies within the poses")));
}

TEST_F(MergeSessions, IsTheSameWhenDoneTwice) {
  EXPECT_EQ(merged({"car", "person"}).points_map, merged({"car", "person"}).points_map);
}

TEST_F(MergeSessions, DoublesItsVoxelsWhereThereAreTooMany) {
  MappingConfig config = default_mapping_config();
  config.max_voxels = 10000;
  const MergedSessions result = merged({"empty"}, config);
  EXPECT_GT(result.report.voxel_m, config.voxel_m);
  EXPECT_LE(result.report.merged, 10000U);
  EXPECT_GT(result.report.kept, result.report.merged * 9 / 10);
}

TEST_F(MergeSessions, ReportsTheProgressOfBothPasses) {
  std::map<std::string, std::size_t> passes;
  std::vector<SurveySession> sessions;
  sessions.emplace_back(folder("empty"), std::chrono::milliseconds(200));
  static_cast<void>(
      merge_sessions(sessions,
                     default_mapping_config(),
                     [&](const std::string& pass, std::size_t done, std::size_t total) {
                       EXPECT_EQ(total, 80U);
                       passes[pass] = done;
                     }));
  EXPECT_THAT(passes,
              ::testing::UnorderedElementsAre(::testing::Pair("points", 80U),
                                              ::testing::Pair("rays", 80U)));
}

}  // namespace
}  // namespace fleetloc
