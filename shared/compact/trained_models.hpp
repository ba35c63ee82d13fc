#pragma once

#include <string>
#include <string_view>

#include "shared/compact/correction_models.hpp"
#include "shared/compact/submap_models.hpp"

namespace fleetloc {

/// All models of the encoding.
struct CompactModels {
  SubmapModels submap;
  CorrectionModels correction;
};

/// In the order of the table; see model_rows.hpp.
template <typename Visit>
void for_each_row(CompactModels& models, const Visit& visit) {
  for_each_row("submap", models.submap, visit);
  for_each_row("correction", models.correction, visit);
}

/// The models of a table as idl/compact_models.txt is one.
/// Throws std::invalid_argument, with the name of a row that is missing, unknown or malformed.
CompactModels read_models(std::string_view table);

/// As every block begins: idl/compact_models.txt.
const CompactModels& trained_models();

}  // namespace fleetloc
