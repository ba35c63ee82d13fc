#include "deploy/evaluation/report/gnuplot.hpp"

#include <array>
#include <cerrno>
#include <csignal>
#include <stdexcept>
#include <system_error>

#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

namespace fleetloc {
namespace {

[[noreturn]] void fail(int error, const std::string& what) {
  throw std::system_error(error, std::generic_category(), what);
}

/// A file without a name, for a child's standard streams: neither side ever waits for the other.
class StreamFile {
 public:
  explicit StreamFile(const char* name) : descriptor_(memfd_create(name, MFD_CLOEXEC)) {
    if (descriptor_ < 0) fail(errno, "memfd_create");
  }
  ~StreamFile() { close(descriptor_); }
  StreamFile(const StreamFile&) = delete;
  StreamFile& operator=(const StreamFile&) = delete;

  [[nodiscard]] int descriptor() const { return descriptor_; }

  void write(const std::string& text) const {
    for (std::size_t written = 0; written < text.size();) {
      const ssize_t count = ::write(descriptor_, text.data() + written, text.size() - written);
      if (count < 0 && errno != EINTR) fail(errno, "script of gnuplot");
      if (count > 0) written += static_cast<std::size_t>(count);
    }
    lseek(descriptor_, 0, SEEK_SET);
  }

  [[nodiscard]] std::string content() const {
    lseek(descriptor_, 0, SEEK_SET);
    std::string text;
    std::array<char, 65536> block{};
    while (true) {
      const ssize_t count = read(descriptor_, block.data(), block.size());
      if (count < 0 && errno == EINTR) continue;
      if (count < 0) fail(errno, "output of gnuplot");
      if (count == 0) return text;
      text.append(block.data(), static_cast<std::size_t>(count));
    }
  }

 private:
  int descriptor_;
};

pid_t started(const StreamFile& input, const StreamFile& output, const StreamFile& errors) {
  std::string program = "gnuplot";
  std::string no_settings_of_the_user = "-d";
  std::array<char*, 3> argv{program.data(), no_settings_of_the_user.data(), nullptr};
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_adddup2(&files, input.descriptor(), STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&files, output.descriptor(), STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&files, errors.descriptor(), STDERR_FILENO);
  pid_t pid = -1;
  const int error = posix_spawnp(&pid, program.c_str(), &files, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&files);
  if (error == ENOENT) {
    throw std::runtime_error(
        "there is no program 'gnuplot', which draws the figures: install the package gnuplot-nox");
  }
  if (error != 0) fail(error, "gnuplot");
  return pid;
}

}  // namespace

std::string gnuplot_output(const std::string& script) {
  const StreamFile input("script");
  const StreamFile output("output");
  const StreamFile errors("errors");
  input.write(script);
  const pid_t pid = started(input, output, errors);
  int status = 0;
  while (waitpid(pid, &status, 0) < 0 && errno == EINTR) {
  }
  if (status != 0) throw std::runtime_error("gnuplot: " + errors.content());
  return output.content();
}

}  // namespace fleetloc
