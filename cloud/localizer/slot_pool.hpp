#pragma once

#include <cassert>
#include <cstddef>
#include <functional>
#include <queue>
#include <vector>

namespace fleetloc {

/// Memory for parameter blocks at fixed addresses. The lowest free block is handed out, so that the
/// order of the addresses depends on the calls alone.
class SlotPool {
 public:
  /// @param block_size  doubles in each of `count` blocks
  SlotPool(std::size_t count, std::size_t block_size)
      : block_size_(block_size), values_(count * block_size) {
    for (std::size_t slot = 0; slot < count; ++slot) free_.push(slot);
  }

  [[nodiscard]] bool is_full() const { return free_.empty(); }

  double* take() {
    assert(!is_full());
    const std::size_t slot = free_.top();
    free_.pop();
    return values_.data() + slot * block_size_;
  }

  void give_back(const double* block) {
    free_.push(static_cast<std::size_t>(block - values_.data()) / block_size_);
  }

 private:
  std::size_t block_size_;
  std::vector<double> values_;
  std::priority_queue<std::size_t, std::vector<std::size_t>, std::greater<>> free_;
};

}  // namespace fleetloc
