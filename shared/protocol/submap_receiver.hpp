#pragma once

#include <cstdint>
#include <optional>

#include "shared/core/time.hpp"
#include "shared/model/localization_result.hpp"

namespace fleetloc {

/// The receiving end of a stream of numbered samples: tells which ones are new and records which
/// were stored. The acknowledgements cover the latest 64 sample numbers; what is older and was
/// never stored is given up and counts as lost.
///
/// A number far from the others, ahead or behind, is believed only when a second one is near it: a
/// single wrong sample must not make all that follow look old, and the first one may be wrong.
class SubmapReceiver {
 public:
  static constexpr std::uint32_t kFar = 1024;

  /// False for a number that was stored before, that is too old to tell, or that is the first one
  /// far from the others.
  bool is_new(SampleNumber number);

  /// To be called after the sample has been validated and stored.
  void store(SampleNumber number, Timestamp now);

  /// How long ago the sample with the highest number was stored; zero without one.
  [[nodiscard]] Duration since_newest(Timestamp now) const {
    return newest_stored_ ? now - *newest_stored_ : Duration{};
  }

  [[nodiscard]] Acknowledgements acknowledgements() const;

  /// Share of the covered numbers up to the newest one that never arrived.
  [[nodiscard]] double loss() const;

  /// The same as an expectation: where few are covered, between that and a link of which nothing is
  /// known.
  [[nodiscard]] double expected_loss() const;

 private:
  std::uint32_t base_ = 0;  // everything below is stored, given up or before the first
  std::uint64_t bitmap_ = 0;
  std::optional<std::uint32_t> far_;  // the latest such number
  std::optional<Timestamp> newest_stored_;
};

}  // namespace fleetloc
