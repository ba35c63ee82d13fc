#include "deploy/evaluation/experiment/plan.hpp"

#include <gmock/gmock.h>

#include "deploy/replay/localizer_plan.hpp"
#include "test/unit/experiment/plan_files.hpp"

namespace fleetloc {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

class PlanFile : public testing::Test {
 protected:
  void SetUp() override { write_small_inputs(); }

  static void expect_refused(const std::string& part,
                             const std::string& other,
                             const std::string& place,
                             const std::string& message) {
    EXPECT_THAT(
        [&] { read_text(with(small_plan(), part, other)); },
        ThrowsMessage<ConfigError>(AllOf(HasSubstr("plan.yaml:" + place), HasSubstr(message))));
  }
};

TEST_F(PlanFile, HoldsTheAxesInItsOrder) {
  const Plan plan = read_text(small_plan());
  std::vector<std::string> names;
  for (const auto& configuration : plan.configurations) names.push_back(configuration.name);
  EXPECT_THAT(names, ElementsAre("default", "short", "alone"));
  EXPECT_TRUE(plan.configurations[2].odometry_only);
  EXPECT_THAT(plan.configurations[1].yaml, HasSubstr("window: 10"));
  EXPECT_THAT(plan.seeds, ElementsAre(1, 2));
  EXPECT_EQ(plan.maps[0].file, test_folder() / "room.pcd");
}

TEST_F(PlanFile, GivesALinkItsDirections) {
  const LinkConfig link = read_text(small_plan()).links.at(1).link;
  EXPECT_EQ(link.uplink.loss, 0.5);
  EXPECT_EQ(link.downlink.loss, 0.5);
  EXPECT_EQ(link.uplink.delay_s, 0.0);
  EXPECT_EQ(link.downlink.delay_s, 2.0);
  EXPECT_EQ(link.uplink.rate_bytes_per_s, 1000.0);
  EXPECT_EQ(link.uplink.queue_bytes, 8000U);
}

TEST_F(PlanFile, MayGiveALinkWhateverALinkFileMay) {
  write("trace.csv", "0, 4000\n10, 9000\n");
  const LinkConfig link =
      read_text(with(small_plan(),
                     "loss: 0.5, bandwidth_bytes_per_s: 1000",
                     "burst_length: 3, jitter_s: 0.1, rate_trace_file: trace.csv, "
                     "outages: [[10, 5]], up: {duplication: 0.1}"))
          .links.at(1)
          .link;
  for (const LinkDirection& direction : {link.uplink, link.downlink}) {
    EXPECT_EQ(direction.burst_length, 3.0);
    EXPECT_EQ(direction.jitter_s, 0.1);
    EXPECT_EQ(direction.rate_trace.steps.size(), 2U);
    EXPECT_EQ(direction.queue_bytes, 18'000U) << "two seconds of the largest rate";
    EXPECT_EQ(direction.outages.at.size(), 1U);
  }
  EXPECT_EQ(link.uplink.duplication, 0.1);
  EXPECT_EQ(link.downlink.duplication, 0.0);
  expect_refused("loss: 0.5", "reordering: 0.5", "13: links.poor.reordering", "needs");
}

TEST_F(PlanFile, MayTakeALinkFromAFileAndChangeIt) {
  write("links/slow.yaml",
        "seed: 9\n"
        "uplink: {loss: 0.1, delay_s: 0.5, rate_bytes_per_s: 4000, queue_bytes: 2000}\n"
        "downlink: {loss: 0.2, delay_s: 0.5, rate_bytes_per_s: 0, queue_bytes: 0}\n");
  const LinkConfig link = read_text(with(small_plan(),
                                         "loss: 0.5, bandwidth_bytes_per_s: 1000",
                                         "file: links/slow.yaml, up: {loss: 0.4}"))
                              .links.at(1)
                              .link;
  EXPECT_EQ(link.uplink.loss, 0.4);
  EXPECT_EQ(link.uplink.rate_bytes_per_s, 4000.0);
  EXPECT_EQ(link.uplink.queue_bytes, 2000U);
  EXPECT_EQ(link.downlink.loss, 0.2);
  EXPECT_EQ(link.downlink.delay_s, 2.0);
  expect_refused("loss: 0.5", "file: none.yaml", "13: links.poor.file", "no such file");
}

TEST_F(PlanFile, FindsTheGroundTruthOfARecording) {
  const auto dataset = std::get<RecordedDataset>(read_text(small_plan()).datasets.at(0).source);
  EXPECT_EQ(dataset.ground_truth,
            test_folder() / "flight/mav0/state_groundtruth_estimate0/data.csv");
}

TEST_F(PlanFile, IsRefusedForUnknownKeys) {
  expect_refused("mode:", "colour: red\nmode:", "2: colour", "unknown key");
  expect_refused("loss: 0.5", "lose: 0.5", "13: links.poor.lose", "unknown key");
  expect_refused(
      "window: 10", "windw: 10", "9: configurations.short.config.localizer.windw", "unknown key");
}

TEST_F(PlanFile, IsRefusedForWhatIsNotThere) {
  expect_refused("file: room.pcd", "file: hall.pcd", "4: maps.room.file", "hall.pcd: no such file");
  expect_refused("folder: flight", "folder: fly", "6: datasets.flight.folder", "no such folder");
  expect_refused("map: room", "map: hall", "6: datasets.flight.map", "there is no map 'hall'");
  expect_refused("folder: flight, ", "", "6: datasets.flight.folder", "missing");
  expect_refused("folder: flight,",
                 "folder: flight, tracks: true,",
                 "6: datasets.flight.folder",
                 "tracks0/data.csv: no such file");
}

TEST_F(PlanFile, IsRefusedForAnEmptyAxis) {
  expect_refused("[1, 2]", "[]", "14: seeds", "is empty");
  expect_refused(
      "  default: {}\n  short: {config: {localizer: {window: 10}}}\n"
      "  alone: {odometry_only: true}\n",
      "  {}\n",
      "7: configurations",
      "is empty");
}

TEST_F(PlanFile, IsRefusedForNamesThatClash) {
  expect_refused("short:", "default:", "9: configurations.default", "duplicate key");
  expect_refused("[1, 2]", "[1, 1]", "14: seeds", "twice");
  expect_refused("short:", "sh/rt:", "9: configurations.sh/rt", "a name is");
}

TEST_F(PlanFile, IsRefusedForValuesOutOfRange) {
  expect_refused("loss: 0.5", "loss: 1.5", "13: links.poor.loss", "must be in 0..1");
  expect_refused("replay", "reply", "2: mode", "must be replay or dds");
  expect_refused("[1, 2]", "[1, two]", "14: seeds", "");
}

TEST_F(PlanFile, NeedsToKnowTheNetworkOfRunsOverDds) {
  write("lan.xml", "profiles");
  const std::string dds =
      with(small_plan(), "mode: replay\n", "mode: dds\ndds: {qos: lan.xml, rate: 2}\n");
  const Plan plan = read_text(dds);
  ASSERT_TRUE(plan.dds);
  EXPECT_EQ(plan.dds->qos, test_folder() / "lan.xml");
  EXPECT_EQ(plan.dds->rate, 2.0);
  expect_refused("mode: replay", "mode: dds", "1: dds", "missing");
  EXPECT_THAT([&] { read_text(with(dds, "default: {}", "default: {align_once: true}")); },
              ThrowsMessage<ConfigError>(HasSubstr("only a replay can")));
  EXPECT_THAT([&] { read_text(with(dds, "default: {}", "default: {baseline: icp}")); },
              ThrowsMessage<ConfigError>(HasSubstr("only a replay can")));

  EXPECT_EQ(qos_of(plan.configurations.front(), *plan.dds), test_folder() / "lan.xml");
  write("wifi.xml", "profiles");
  const Plan other = read_text(with(dds, "default: {}", "default: {qos: wifi.xml}"));
  EXPECT_EQ(qos_of(other.configurations.front(), *other.dds), test_folder() / "wifi.xml");
  EXPECT_THAT([&] { read_text(with(small_plan(), "default: {}", "default: {qos: wifi.xml}")); },
              ThrowsMessage<ConfigError>(HasSubstr("only with mode: dds")));
}

TEST_F(PlanFile, KnowsOneBaseline) {
  EXPECT_TRUE(read_text(with(small_plan(), "default: {}", "default: {baseline: icp}"))
                  .configurations.front()
                  .icp_baseline);
  expect_refused(
      "default: {}", "default: {baseline: gicp}", "8: configurations.default.baseline", "icp");
}

TEST_F(PlanFile, SaysWhatBecomesOfTheLocalizers) {
  const std::string killed =
      "default: {localizers: {events: [{at_s: 0, localizer: first, event: start}, "
      "{at_s: 3, localizer: first, event: kill}]}}";
  const std::string yaml =
      read_text(with(small_plan(), "default: {}", killed)).configurations.front().localizers;
  const auto events = read_localizer_plan(ConfigReader::from_string(yaml)).events;
  ASSERT_EQ(events.size(), 2U);
  EXPECT_EQ(events.back().at_s, 3.0);
  EXPECT_EQ(events.back().kind, LocalizerPlan::Kind::kKill);
  expect_refused("default: {}", with(killed, "kill", "die"), "8", "none of start, stop, kill");
  expect_refused("default: {}",
                 with(killed, "default: {", "default: {odometry_only: true, "),
                 "8: configurations.default.localizers",
                 "has none");
  expect_refused("default: {}",
                 with(killed, "default: {", "default: {baseline: icp, "),
                 "8: configurations.default.localizers",
                 "has none");
  write("lan.xml", "profiles");
  const std::string dds =
      with(small_plan(), "mode: replay\n", "mode: dds\ndds: {qos: lan.xml, rate: 2}\n");
  EXPECT_THAT([&] { read_text(with(dds, "default: {}", killed)); },
              ThrowsMessage<ConfigError>(HasSubstr("only a replay can")));
}

TEST_F(PlanFile, IsRefusedForWhatTheProgramsWouldRefuse) {
  write("plan.yaml", small_plan());
  const auto check = [](const ConfigReader& config) {
    ConfigReader reader = config;
    reader.section("localizer").integer("window", 20, 1000);
  };
  EXPECT_THAT([&] { read_plan(test_folder() / "plan.yaml", check); },
              ThrowsMessage<ConfigError>(
                  HasSubstr("plan.yaml:9: configurations.short.config.localizer.window")));
}

TEST_F(PlanFile, IsRefusedForASessionThatTheSceneDoesNotHave) {
  const std::string scene = std::string(FLEETLOC_SOURCE_DIR) + "/deploy/worlds/campus.yaml";
  expect_refused("folder: flight, ",
                 "simulated: {scene: " + scene + ", route: " + scene + ", season: monsoon}, ",
                 "6: datasets.flight.simulated.season",
                 "'monsoon' is not in");
}

TEST_F(PlanFile, IsRefusedForStreetsThatAreNotThere) {
  const std::string scene = std::string(FLEETLOC_SOURCE_DIR) + "/deploy/worlds/campus.yaml";
  expect_refused("folder: flight, ",
                 "simulated: {scene: " + scene + ", route: " + scene +
                     ", built_along: nowhere.yaml, season: autumn}, ",
                 "6: datasets.flight.simulated.built_along",
                 "no such file");
}

}  // namespace
}  // namespace fleetloc
