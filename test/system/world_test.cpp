// From a made-up world to a pose in its map: survey, drive, map, localization, errors.
#include <cmath>
#include <fstream>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "shared/geometry/pose.hpp"
#include "shared/geometry/so3.hpp"
#include "shared/trajectory/tum_file.hpp"
#include "test/system/recorded_flight.hpp"

namespace fleetloc {
namespace {

using Words = std::vector<std::string>;

constexpr const char* kDriven_s = "22";
const std::string kWorlds = FLEETLOC_SOURCE_DIR "/deploy/worlds/";

/// The ground truth at the first frame, displaced by 0.3 m and 3 degrees of yaw.
std::string displaced_start(const std::filesystem::path& ground_truth, Timestamp first_frame) {
  for (const StampedPose& pose : read_trajectory(ground_truth)) {
    if (pose.stamp < first_frame) continue;
    const Eigen::Quaterniond R =
        exp_so3(Eigen::Vector3d(0.0, 0.0, 3.0 * M_PI / 180.0)) * pose.T_ref_body.R;
    const Eigen::Vector3d p = pose.T_ref_body.p + Eigen::Vector3d(0.2, -0.2, 0.1);
    std::ostringstream text;
    text << p.transpose() << ' ' << R.coeffs().transpose();
    return text.str();
  }
  return "";
}

class World : public testing::Test {
 protected:
  void SetUp() override {
    if (kSanitized) GTEST_SKIP() << "too slow with sanitizers; the programs' parts run elsewhere";
    std::ofstream(scratch_ / "ten_hertz.yaml") << "sim: {images: {rate_hz: 10}}\n";
  }

  [[nodiscard]] std::string path(const std::string& name) const {
    return (scratch_ / name).string();
  }

  void simulate(const std::string& out, const Words& more) const {
    Words words{"--scene",
                kWorlds + "campus.yaml",
                "--route",
                kWorlds + "quad.yaml",
                "--config",
                path("ten_hertz.yaml"),
                "--duration",
                kDriven_s,
                "--out",
                path(out)};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = run(FLEETLOC_SIM, words);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
  }

  void build_map() const {
    simulate("survey", {"--no-images", "--lidar"});
    const Outcome outcome = run(
        FLEETLOC_MAP,
        {"build", "--cloud", path("survey/mav0/pointcloud0/data.ply"), "--out", path("map.pcd")});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
  }

  [[nodiscard]] std::string ground_truth(const std::string& drive) const {
    return path(drive + "/mav0/state_groundtruth_estimate0/data.csv");
  }

  /// What fleetloc-eval says of a replay in the map.
  [[nodiscard]] nlohmann::json localized(const std::string& drive, const Words& more) const {
    const auto first = read_trajectory(ground_truth(drive)).front().stamp;
    Words words{"--dataset",
                path(drive),
                "--map",
                path("map.pcd"),
                "--initial-pose",
                displaced_start(ground_truth(drive), first),
                "--out",
                path("run_" + drive)};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome replay = run(FLEETLOC_REPLAY, words);
    EXPECT_EQ(replay.exit_code, 0) << replay.errors;
    const Outcome eval =
        run(FLEETLOC_EVAL, {"--run", path("run_" + drive), "--ground-truth", ground_truth(drive)});
    EXPECT_EQ(eval.exit_code, 0) << eval.errors;
    return parsed_json(path("run_" + drive + "/evaluation.json"));
  }

  const ScratchFolder scratch_;
};

TEST_F(World, IsGoodEnoughToLocalizeInByImagesAndByTracks) {
  build_map();
  simulate("images", {"--session", "summer", "--seed", "2"});
  simulate("tracks", {"--session", "autumn", "--seed", "2", "--tracks"});
  const auto by_images = localized("images", {});
  const auto by_tracks = localized("tracks", {"--tracks"});
  for (const auto& errors : {by_images, by_tracks}) {
    SCOPED_TRACE(errors.dump());
    EXPECT_LT(errors["ate"]["median"], 0.15);
    EXPECT_LT(errors["odometry_ate"]["rmse"], 0.1);
    EXPECT_GT(errors["coverage"], 0.9);
  }
}

}  // namespace
}  // namespace fleetloc
