#pragma once

#include <atomic>
#include <exception>
#include <thread>
#include <vector>

namespace fleetloc {

/// Calls `work(row)` once for each row in [0, rows), on `threads` threads. Rows must not depend on
/// each other. An exception of `work` is rethrown after the other rows.
template <typename Work>
void for_each_row(int rows, int threads, const Work& work) {
  std::atomic<int> next = 0;
  std::vector<std::exception_ptr> errors(static_cast<std::size_t>(threads));
  const auto run = [&](std::exception_ptr& error) noexcept {
    try {
      for (int row = next++; row < rows; row = next++) work(row);
    } catch (...) {
      error = std::current_exception();
    }
  };
  {
    std::vector<std::jthread> others;
    for (std::size_t i = 1; i < errors.size(); ++i) {
      others.emplace_back([&run, &error = errors[i]] { run(error); });
    }
    run(errors.front());
  }
  for (const std::exception_ptr& error : errors) {
    if (error) std::rethrow_exception(error);
  }
}

}  // namespace fleetloc
