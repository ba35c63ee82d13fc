#pragma once

#include <cstdint>

#include "shared/model/localization_result.hpp"

namespace fleetloc {

/// The localizer's end of one session's submap stream: tells which samples are new and records
/// which were stored. The acknowledgements cover the latest 64 sample numbers; what is older and
/// was never stored is given up and counts as lost.
class SubmapReceiver {
 public:
  /// False for a number that was stored before, or that is too old to tell.
  [[nodiscard]] bool is_new(SampleNumber number) const;

  /// To be called after the sample has been validated and stored.
  void store(SampleNumber number);

  [[nodiscard]] Acknowledgements acknowledgements() const;

  /// Share of the covered numbers up to the newest one that never arrived.
  [[nodiscard]] double loss() const;

 private:
  std::uint32_t base_ = 0;  // everything below is stored, given up or before the first
  std::uint64_t bitmap_ = 0;
};

}  // namespace fleetloc
