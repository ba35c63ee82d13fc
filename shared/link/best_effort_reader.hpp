#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace fleetloc {

/// What a best-effort reader of Fast DDS 2.9.1 (StatelessReader) gives out of what arrives of one
/// writer: a sample that is whole and newer than the last one that it gave out. What arrives behind
/// a newer sample is dropped, and so is a duplicate. It puts together the fragments of one sample
/// at a time: those of a newer one replace it, those of an older one are dropped. test/transport
/// compares the two.
class BestEffortReader {
 public:
  /// A datagram arrives.
  /// @param number     of its sample, from 1, in the order of writing
  /// @param fragment   of `fragments` that the sample has
  /// @return whether the sample is now complete and given out
  bool receive(std::uint64_t number, std::size_t fragment, std::size_t fragments);

 private:
  std::uint64_t last_ = 0;     // that was given out
  std::uint64_t partial_ = 0;  // of which fragments are held
  std::vector<bool> held_;
};

}  // namespace fleetloc
