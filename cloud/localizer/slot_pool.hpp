#pragma once

#include <cassert>
#include <cstddef>
#include <functional>
#include <queue>
#include <vector>

namespace fleetloc {

/// Memory for parameter blocks at addresses that stay, of which the lowest free one is handed out:
/// the order of the blocks' addresses depends on nothing but the calls.
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
