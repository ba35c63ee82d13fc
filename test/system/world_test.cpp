// From a made-up world to a pose in its map: survey, drive, map, localization, errors.
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "test/system/recorded_flight.hpp"

namespace fleetloc {
namespace {

using Words = std::vector<std::string>;

const std::string kWorlds = FLEETLOC_SOURCE_DIR "/deploy/worlds/";

class World : public testing::Test {
 protected:
  void SetUp() override {
    if (kSanitized) GTEST_SKIP() << "too slow with sanitizers; the programs' parts run elsewhere";
    std::ofstream(scratch_ / "ten_hertz.yaml") << "sim: {images: {rate_hz: 10}}\n";
  }

  /// The same 40 s of the same way each time.
  [[nodiscard]] RecordedFlight simulated(const std::string& name, const Words& more) const {
    const auto folder = scratch_ / name;
    Words words{"--scene",
                kWorlds + "campus.yaml",
                "--route",
                kWorlds + "quad.yaml",
                "--config",
                (scratch_ / "ten_hertz.yaml").string(),
                "--duration",
                "40",
                "--out",
                folder.string()};
    words.insert(words.end(), more.begin(), more.end());
    must_run(FLEETLOC_SIM, words);
    return {.folder = folder,
            .ground_truth = folder / "mav0" / "state_groundtruth_estimate0" / "data.csv"};
  }

  /// What fleetloc-eval says of a replay in the map.
  [[nodiscard]] nlohmann::json localized(const RecordedFlight& drive, Words words) const {
    const auto run_folder = drive.folder / "run";
    words.insert(words.end(), {"--dataset", drive.folder.string(), "--out", run_folder.string()});
    must_run(FLEETLOC_REPLAY, words);
    return run_errors(run_folder, drive);
  }

  static void expect_localized(const nlohmann::json& errors, double ate_m, double covered) {
    EXPECT_LT(errors["ate"]["median"], ate_m) << errors;
    EXPECT_LT(errors["odometry_ate"]["rmse"], 0.1) << errors;
    EXPECT_GT(errors["covered"], covered) << errors;
    EXPECT_EQ(errors["confidence"]["confidently_wrong"], 0) << errors;
  }

  const ScratchFolder scratch_;
};

TEST_F(World, IsGoodEnoughToLocalizeInByImagesAndByTracks) {
  const auto map = built_map(simulated("survey", {"--no-images", "--lidar"}), scratch_).string();
  const auto images = simulated("images", {"--season", "summer", "--seed", "2"});
  const auto tracks = simulated("tracks", {"--season", "autumn", "--seed", "2", "--tracks"});
  const Words in_map{"--map", map, "--initial-pose", images.displaced_start_pose()};
  Words by_tracks = in_map;
  by_tracks.emplace_back("--tracks");
  // Twenty seeds by tracks: median error .013 to .037 m, covered .87 to 1 (of 40 s, some without an
  // answer: a robot that stands sees too little to be sure), NEES .29 to .80, worst .18 m.
  const auto tracked = localized(tracks, by_tracks);
  expect_localized(tracked, 0.08, 0.8);
  EXPECT_LT(tracked["nees"]["map"], 2.0) << tracked;
  EXPECT_LT(tracked["confidence"]["worst_m"], 0.3) << tracked;
  // Five by images: .035, .073, .23, .13 and .06 m, covered .41 to .88, NEES 1.3 to 11.5. This one
  // is the second; what is not right there yet: deploy/experiments, "A short drive by images".
  expect_localized(localized(images, in_map), 0.15, 0.7);
}

}  // namespace
}  // namespace fleetloc
