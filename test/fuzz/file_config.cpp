#include "cloud/laser_map/build_map.hpp"
#include "cloud/mapping/mapping_config.hpp"
#include "cloud/pool/localizer_pool.hpp"
#include "deploy/config/default_config.hpp"
#include "deploy/evaluation/errors/eval_run.hpp"
#include "deploy/replay/icp_localizer.hpp"
#include "deploy/sim/recording/sim_config.hpp"
#include "robot/cloud_client/cloud_client.hpp"
#include "robot/pipeline/robot_pipeline.hpp"
#include "test/fuzz/input_files.hpp"

namespace fleetloc {
namespace {

/// As the programs do.
void read_all(const ConfigReader& config) {
  ConfigReader reader = config;
  read_robot_pipeline_config(config);
  read_keyframe_worker_config(config);
  read_cloud_client_config(reader.section("client"));
  read_localizer_pool_config(config);
  read_icp_localizer_config(reader.section("icp_baseline"));
  read_map_config(reader.section("map"));
  read_mapping_config(config);
  read_evaluation_config(reader.section("evaluation"));
  read_sim_config(reader.section("sim"));
}

}  // namespace
}  // namespace fleetloc

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace fleetloc;
  const auto file = input_file("config.yaml", data, size);
  read_or_refuse<ConfigError>([&] {
    const auto user = ConfigReader::from_file(file);
    auto config = ConfigReader::from_string(default_config("everything"), "defaults");
    config.overlay(user);
    read_all(config);
    const std::string text = config.text();
    require(ConfigReader::from_string(text).text() == text, "what is written is read as the same");
  });
  return 0;
}
