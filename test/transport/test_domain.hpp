#pragma once

#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

namespace fleetloc {

/// A DDS domain that no other test of this machine uses while this object lives. Held by a file
/// lock, which the kernel releases however the process ends.
class TestDomain {
 public:
  TestDomain() {
    const auto folder = std::filesystem::temp_directory_path();
    for (number_ = 1; number_ <= 100; ++number_) {
      const auto file = folder / ("fleetloc_test_domain_" + std::to_string(number_));
      lock_ = open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
      if (lock_ < 0) continue;
      if (flock(lock_, LOCK_EX | LOCK_NB) == 0) return;
      close(lock_);
    }
    throw std::runtime_error("no free DDS domain");
  }
  ~TestDomain() { close(lock_); }
  TestDomain(const TestDomain&) = delete;
  TestDomain& operator=(const TestDomain&) = delete;

  std::uint32_t number() const { return number_; }

 private:
  std::uint32_t number_ = 0;
  int lock_ = -1;
};

}  // namespace fleetloc
