#include "test/system/kept_folder.hpp"

#include <algorithm>
#include <fstream>
#include <stdexcept>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

namespace fleetloc {
namespace {

namespace fs = std::filesystem;

/// One process at a time has it.
class FileLock {
 public:
  explicit FileLock(const fs::path& file)
      : descriptor_(open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644)) {
    if (descriptor_ < 0 || flock(descriptor_, LOCK_EX) != 0) {
      throw std::runtime_error(file.string() + ": cannot be locked");
    }
  }
  ~FileLock() { close(descriptor_); }
  FileLock(const FileLock&) = delete;
  FileLock& operator=(const FileLock&) = delete;

 private:
  int descriptor_;
};

bool is_newer_than(const fs::path& made, const std::vector<fs::path>& makers) {
  return fs::exists(made) && std::ranges::none_of(makers, [&made](const fs::path& maker) {
           return fs::last_write_time(maker) > fs::last_write_time(made);
         });
}

}  // namespace

void keep(const fs::path& folder,
          const std::vector<fs::path>& makers,
          const std::function<void(const fs::path& folder)>& make) {
  fs::create_directories(folder.parent_path());
  const FileLock lock(folder.string() + ".lock");
  const fs::path made = folder / "made";
  if (is_newer_than(made, makers)) return;
  fs::remove_all(folder);
  fs::create_directories(folder);
  make(folder);
  std::ofstream stream(made);
  for (const fs::path& maker : makers) stream << "by " << maker.string() << '\n';
}

}  // namespace fleetloc
