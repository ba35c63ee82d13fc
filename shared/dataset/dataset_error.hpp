#pragma once

#include <stdexcept>

namespace fleetloc {

/// A dataset that cannot be read or written. The message names the file, and the line if it has
/// one.
class DatasetError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace fleetloc
