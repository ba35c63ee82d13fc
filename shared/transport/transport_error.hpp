#pragma once

#include <stdexcept>

namespace fleetloc {

/// A transport that cannot be set up. The message says what was asked for and why it failed.
class TransportError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace fleetloc
