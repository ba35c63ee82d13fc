#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace fleetloc {

/// Percentiles of any number of positive values in fixed memory (8 KB), for programs that run for
/// months: bins whose edges grow by 1 %, from 1e-4 to 1e5. What lies outside counts in the first or
/// last bin; NaN is not counted.
class Histogram {
 public:
  void add(double value) {
    if (std::isnan(value)) return;
    ++bins_[bin_of(value)];
    min_ = count_ == 0 ? value : std::min(min_, value);
    max_ = count_ == 0 ? value : std::max(max_, value);
    ++count_;
    sum_ += value;
  }

  [[nodiscard]] std::uint64_t count() const { return count_; }
  [[nodiscard]] double sum() const { return sum_; }

  /// The value at `share` (0..1) of the sorted values, by nearest rank, to 0.5 %; nothing of
  /// nothing.
  [[nodiscard]] std::optional<double> percentile(double share) const {
    if (count_ == 0) return std::nullopt;
    const auto rank =
        static_cast<std::uint64_t>(std::llround(share * static_cast<double>(count_ - 1)));
    if (rank == 0) return min_;
    if (rank == count_ - 1) return max_;
    std::size_t bin = 0;
    for (std::uint64_t below = bins_[0]; below <= rank; below += bins_[bin]) ++bin;
    return kMin * std::exp(kLogStep * (static_cast<double>(bin) + 0.5));
  }

 private:
  static constexpr double kMin = 1e-4;
  static constexpr double kLogStep = 0.00995033085316808;  // log(1.01)
  static constexpr std::size_t kBins = 2083;               // to 1e5

  static std::size_t bin_of(double value) {
    if (!(value > kMin)) return 0;
    const double bin = std::log(value / kMin) / kLogStep;
    return bin < static_cast<double>(kBins - 1) ? static_cast<std::size_t>(bin) : kBins - 1;
  }

  std::array<std::uint32_t, kBins> bins_{};
  std::uint64_t count_ = 0;
  double sum_ = 0.0;
  double min_ = 0.0;
  double max_ = 0.0;
};

}  // namespace fleetloc
