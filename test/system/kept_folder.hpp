#pragma once

#include <filesystem>
#include <functional>
#include <vector>

namespace fleetloc {

/// Makes `folder` by `make`, unless it is there and newer than each of `makers`, the files that it
/// depends on. One process at a time: who asks meanwhile waits.
void keep(const std::filesystem::path& folder,
          const std::vector<std::filesystem::path>& makers,
          const std::function<void(const std::filesystem::path& folder)>& make);

}  // namespace fleetloc
