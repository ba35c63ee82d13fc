#include "deploy/tools/eval_diagnostics.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "shared/config/delimited_file.hpp"

namespace fleetloc {
namespace {

constexpr std::size_t kTriangle = 21;
using Columns = std::array<std::size_t, kTriangle>;  // of the upper triangle, row by row

std::size_t column_named(const DelimitedFile& header, const std::string& name) {
  for (std::size_t column = 0; column < header.columns(); ++column) {
    if (header.text(column) == name) return column;
  }
  header.fail("there is no column '" + name + "'");
}

Columns columns_of(const DelimitedFile& header, const std::string& prefix) {
  Columns columns{};
  std::size_t next = 0;
  for (int row = 1; row <= 6; ++row) {
    for (int column = row; column <= 6; ++column) {
      columns[next++] = column_named(header, prefix + std::to_string(row) + std::to_string(column));
    }
  }
  return columns;
}

std::optional<Matrix6d> covariance(const DelimitedFile& file, const Columns& columns) {
  const auto is_unknown = [&file](std::size_t column) {
    const std::string_view text = file.text(column);
    return text.empty() || text == "nan" || text == "-nan";
  };
  if (std::ranges::any_of(columns, is_unknown)) return std::nullopt;
  Matrix6d matrix;
  std::size_t next = 0;
  for (int i = 0; i < 6; ++i) {
    for (int j = i; j < 6; ++j) matrix(i, j) = matrix(j, i) = file.number(columns[next++]);
  }
  return matrix;
}

}  // namespace

RunCovariances read_covariances(const std::filesystem::path& path) {
  DelimitedFile file(path, ',');
  RunCovariances covariances;
  if (!file.next()) throw TextFileError(path.string() + ": has no header");
  const std::size_t columns = file.columns();
  const std::size_t stamp_column = column_named(file, "stamp_s");
  const std::size_t state_column = column_named(file, "state");
  const Columns map = columns_of(file, "cm");
  const Columns odom = columns_of(file, "co");
  std::optional<Timestamp> before;
  while (file.next()) {
    file.expect_columns(columns);
    const Timestamp stamp = file.seconds(stamp_column);
    if (before && stamp <= *before) file.fail("the stamp is not later than the one before");
    before = stamp;
    if (file.text(state_column) == "localized") covariances.localized.push_back(stamp);
    if (const auto C = covariance(file, map)) covariances.map.push_back({stamp, *C});
    if (const auto C = covariance(file, odom)) covariances.odom.push_back({stamp, *C});
  }
  return covariances;
}

}  // namespace fleetloc
