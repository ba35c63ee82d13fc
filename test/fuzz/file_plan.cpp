#include "deploy/evaluation/experiment/plan.hpp"
#include "test/fuzz/input_files.hpp"

/// A plan, and the link, the world and the route that it may name.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace fleetloc;
  static const bool has_inputs = [] {
    std::filesystem::create_directories(test_folder() / "flight/mav0/cam0");
    input_file("flight/mav0/cam0/data.csv", "1000,1000.png\n");
    input_file("truth.csv", "1000,0,0,0,1,0,0,0\n");
    input_file("room.pcd", "points");
    return true;
  }();
  require(has_inputs, "there is what a plan names");
  const auto parts = input_parts(data, size, 4);
  const auto file = input_file("plan.yaml", parts[0]);
  input_file("link.yaml", parts[1]);
  input_file("world.yaml", parts[2]);
  input_file("route.yaml", parts[3]);
  read_or_refuse<ConfigError>([&] { read_plan(file, [](const ConfigReader&) {}); });
  return 0;
}
