#pragma once

#include <CLI/CLI.hpp>

namespace fleetloc {

/// Checks of an option's value. Unlike CLI11's own they refuse what is not a number (nan), what is
/// infinite, and a minus before a number without a sign.

/// A number in [min, max].
CLI::Validator number_in(double min, double max);

/// A number in (0, max].
CLI::Validator positive_up_to(double max);

/// A whole number from 0 on.
CLI::Validator whole_number();

inline constexpr double kLongest_s = 1e6;   ///< of what is recorded, played or waited for
inline constexpr double kMaxRate = 1000.0;  ///< of playing, in real time's

}  // namespace fleetloc
