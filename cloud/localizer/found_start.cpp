#include "cloud/localizer/found_start.hpp"

namespace fleetloc {

FoundStart::Config read_found_start_config(ConfigReader section) {
  return {.sigma_cells = section.positive("sigma_cells"),
          .sigma_rad = section.positive("sigma_rad"),
          .max_way_m = section.positive("max_way_m"),
          .max_refused_way_m = section.positive("max_refused_way_m")};
}

}  // namespace fleetloc
