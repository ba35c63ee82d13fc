#include "deploy/evaluation/errors/diagnostics_file.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

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

bool is_unknown(std::string_view text) {
  return text.empty() || text == "nan" || text == "-nan";
}

std::optional<Matrix6d> covariance(const DelimitedFile& file, const Columns& columns) {
  if (std::ranges::any_of(columns,
                          [&file](auto column) { return is_unknown(file.text(column)); })) {
    return std::nullopt;
  }
  Matrix6d matrix;
  std::size_t next = 0;
  for (int i = 0; i < 6; ++i) {
    for (int j = i; j < 6; ++j) matrix(i, j) = matrix(j, i) = file.number(columns[next++]);
  }
  return matrix;
}

/// Goes through the lines after the header, whose stamps must increase.
template <typename Take>
void for_each_line(DelimitedFile& file, const Take& take) {
  const std::size_t columns = file.columns();
  const std::size_t stamp_column = column_named(file, "stamp_s");
  std::optional<Timestamp> before;
  while (file.next()) {
    file.expect_columns(columns);
    const Timestamp stamp = file.seconds(stamp_column);
    if (before && stamp <= *before) file.fail("the stamp is not later than the one before");
    before = stamp;
    take(stamp);
  }
}

DelimitedFile with_header(const std::filesystem::path& path) {
  DelimitedFile file(path, ',');
  if (!file.next()) throw TextFileError(path.string() + ": has no header");
  return file;
}

}  // namespace

RunCovariances read_covariances(const std::filesystem::path& path) {
  DelimitedFile file = with_header(path);
  RunCovariances covariances;
  const std::size_t state_column = column_named(file, "state");
  const Columns map = columns_of(file, "cm");
  const Columns odom = columns_of(file, "co");
  for_each_line(file, [&](Timestamp stamp) {
    const std::string_view state = file.text(state_column);
    if (!covariances.first_frame) covariances.first_frame = stamp;
    if (!covariances.frames.empty() || state != "initializing") covariances.frames.push_back(stamp);
    if (state == "localized") covariances.localized.push_back(stamp);
    if (const auto C = covariance(file, map)) covariances.map.push_back({stamp, *C});
    if (const auto C = covariance(file, odom)) covariances.odom.push_back({stamp, *C});
  });
  return covariances;
}

std::vector<FrameDiagnostics> read_frame_diagnostics(const std::filesystem::path& path) {
  DelimitedFile file = with_header(path);
  const std::size_t state = column_named(file, "state");
  const std::size_t uplink = column_named(file, "uplink_bytes");
  const std::size_t downlink = column_named(file, "downlink_bytes");
  const std::size_t loss = column_named(file, "loss");
  const std::size_t round_trip = column_named(file, "round_trip_s");
  std::vector<FrameDiagnostics> frames;
  for_each_line(file, [&](Timestamp stamp) {
    FrameDiagnostics frame{.stamp = stamp,
                           .state = std::string(file.text(state)),
                           .uplink_bytes = file.number(uplink),
                           .downlink_bytes = file.number(downlink),
                           .loss = file.number(loss),
                           .round_trip_s = std::nullopt};
    if (!is_unknown(file.text(round_trip))) frame.round_trip_s = file.number(round_trip);
    frames.push_back(std::move(frame));
  });
  return frames;
}

}  // namespace fleetloc
