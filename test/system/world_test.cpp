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

  const ScratchFolder scratch_;
};

TEST_F(World, IsGoodEnoughToLocalizeInByImagesAndByTracks) {
  const auto map = built_map(simulated("survey", {"--no-images", "--lidar"}), scratch_).string();
  const auto images = simulated("images", {"--season", "summer", "--seed", "2"});
  const auto tracks = simulated("tracks", {"--season", "autumn", "--seed", "2", "--tracks"});
  const Words in_map{"--map", map, "--initial-pose", images.displaced_start_pose()};
  Words by_tracks = in_map;
  by_tracks.emplace_back("--tracks");
  for (const auto& errors : {localized(images, in_map), localized(tracks, by_tracks)}) {
    SCOPED_TRACE(errors.dump());
    EXPECT_LT(errors["ate"]["median"], 0.15);
    EXPECT_LT(errors["odometry_ate"]["rmse"], 0.1);
    // Of 40 s, some of them without an answer: a robot that stands sees too little to be sure.
    EXPECT_GT(errors["covered"], 0.7);
  }
}

}  // namespace
}  // namespace fleetloc
