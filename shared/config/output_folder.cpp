#include "shared/config/output_folder.hpp"

#include <cerrno>
#include <stdexcept>
#include <system_error>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

namespace fleetloc {
namespace {

int opened(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  const int descriptor = error ? -1 : ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor >= 0) return descriptor;
  if (!error) error.assign(errno, std::generic_category());
  throw std::runtime_error(folder.string() + ": " + error.message());
}

}  // namespace

OutputFolder::OutputFolder(const std::filesystem::path& folder) : descriptor_(opened(folder)) {
  if (::flock(descriptor_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return;
  ::close(descriptor_);
  throw std::runtime_error(folder.string() + ": another program is writing there");
}

OutputFolder::~OutputFolder() {
  ::close(descriptor_);
}

}  // namespace fleetloc
