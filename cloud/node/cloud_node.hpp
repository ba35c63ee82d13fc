#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <stop_token>
#include <string>

#include "cloud/pool/localizer_pool.hpp"
#include "shared/link/link_model.hpp"

namespace fleetloc {

struct CloudNodeOptions {
  std::filesystem::path map;
  std::filesystem::path qos;
  std::filesystem::path out;
  std::string name;
  std::uint32_t domain = 0;
  int workers = 1;
  std::optional<LinkConfig> link;
};

/// Serves robots until a stop is requested, then writes sessions.json. Throws TransportError or
/// std::runtime_error if it cannot start.
void serve_map(const CloudNodeOptions& options, const LocalizerPool::Config& config,
               const std::stop_token& stop);

}  // namespace fleetloc
