// fuzz_seeds FOLDER: writes valid inputs for every target of test/fuzz, by the encoders of the
// project and from its own files.
#include "test/fuzz/seeds.hpp"

#include <exception>
#include <iostream>

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: fuzz_seeds FOLDER\n";
    return 2;
  }
  try {
    const fleetloc::SeedFolder seeds(argv[1]);
    add_wire_seeds(seeds);
    add_ros2_seeds(seeds);
    add_rtps_seeds(seeds);
    add_map_seeds(seeds);
    add_recording_seeds(seeds);
    add_config_seeds(seeds);
  } catch (const std::exception& error) {
    std::cerr << "fuzz_seeds: " << error.what() << '\n';
    return 1;
  }
  return 0;
}
