#include "shared/link/link_config.hpp"
#include "test/fuzz/input_files.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace fleetloc;
  const auto parts = input_parts(data, size, 2);
  const auto file = input_file("link.yaml", parts[0]);
  input_file("trace.csv", parts[1]);
  read_or_refuse<ConfigError>([&] {
    const LinkConfig link = read_link_file(file);
    const std::string text = link_yaml(link);
    const auto again = ConfigReader::from_string(text);
    require(link_yaml(read_link_config(again)) == text, "what is written is read as the same");
  });
  return 0;
}
