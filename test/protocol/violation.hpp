#pragma once

#include <stdexcept>
#include <string>

namespace fleetloc {

/// An invariant that does not hold; says which and where.
class Violation : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

inline void expect(bool holds, const std::string& otherwise) {
  if (!holds) throw Violation(otherwise);
}

}  // namespace fleetloc
