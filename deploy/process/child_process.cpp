#include "deploy/process/child_process.hpp"

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <system_error>

#include <fcntl.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

namespace fleetloc {
namespace {

[[noreturn]] void fail(int error, const std::string& what) {
  throw std::system_error(error, std::generic_category(), what);
}

class Descriptor {
 public:
  Descriptor(int number, const std::string& what) : number_(number) {
    if (number < 0) fail(errno, what);
  }
  ~Descriptor() { close(number_); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  [[nodiscard]] int number() const { return number_; }

 private:
  int number_;
};

int opened_for_writing(const std::filesystem::path& file) {
  constexpr mode_t kMode = 0666;
  return open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_APPEND | O_CLOEXEC, kMode);
}

/// What the child needs, made beforehand: between fork and exec nothing may be allocated.
struct Preparation {
  std::vector<char*> argv;
  int input;
  int output;
  int errors;
  int failure;  ///< pipe that takes errno if exec fails
  pid_t parent;
};

[[noreturn]] void become(const Preparation& preparation) {
  sigset_t none;
  sigemptyset(&none);
  pthread_sigmask(SIG_SETMASK, &none, nullptr);
  setpgid(0, 0);
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  const bool is_orphan = getppid() != preparation.parent;  // ended before prctl
  if (!is_orphan && dup2(preparation.input, STDIN_FILENO) >= 0 &&
      dup2(preparation.output, STDOUT_FILENO) >= 0 &&
      dup2(preparation.errors, STDERR_FILENO) >= 0) {
    execv(preparation.argv.front(), preparation.argv.data());
  }
  const int error = errno;
  [[maybe_unused]] const ssize_t written = write(preparation.failure, &error, sizeof error);
  constexpr int kNotFound = 127;
  _exit(kNotFound);
}

double seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

/// False if `limit_ms` passed; a negative limit is none.
bool wait_until_readable(std::vector<pollfd> watched, int limit_ms) {
  while (true) {
    const int count = poll(watched.data(), watched.size(), limit_ms);
    if (count >= 0) return count > 0;
    if (errno != EINTR) fail(errno, "poll");
  }
}

}  // namespace

ChildProcess::ChildProcess(const ChildCommand& command) {
  std::vector<std::string> arguments = command.arguments;
  Preparation preparation{};
  for (std::string& argument : arguments) preparation.argv.push_back(argument.data());
  preparation.argv.push_back(nullptr);
  const Descriptor input(open("/dev/null", O_RDONLY | O_CLOEXEC), "/dev/null");
  const Descriptor output(opened_for_writing(command.output), command.output.string());
  const Descriptor errors(opened_for_writing(command.errors), command.errors.string());
  std::array<int, 2> pipe_ends{};
  if (pipe2(pipe_ends.data(), O_CLOEXEC) != 0) fail(errno, "pipe");
  const Descriptor failed(pipe_ends[0], "pipe");
  preparation.input = input.number();
  preparation.output = output.number();
  preparation.errors = errors.number();
  preparation.failure = pipe_ends[1];
  preparation.parent = getpid();
  {
    const Descriptor failure(pipe_ends[1], "pipe");
    pid_ = fork();
    if (pid_ < 0) fail(errno, "fork");
    if (pid_ == 0) become(preparation);
  }
  int error = 0;
  if (read(failed.number(), &error, sizeof error) == sizeof error) {  // else exec closed the pipe
    waitpid(pid_, nullptr, 0);
    fail(error, command.arguments.front());
  }
  // By its number: the header of glibc 2.36 cannot be linked from C++.
  descriptor_ = static_cast<int>(syscall(SYS_pidfd_open, pid_, 0));
  if (descriptor_ < 0) {
    const int reason = errno;
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
    fail(reason, "pidfd_open");
  }
}

ChildProcess::~ChildProcess() {
  if (!end_) {
    signal(SIGKILL);
    reap();
  }
  close(descriptor_);
}

void ChildProcess::signal(int number) const {
  if (!end_) kill(-pid_, number);
}

ExitStatus ChildProcess::reap() {
  siginfo_t ignored{};
  const auto id = static_cast<id_t>(pid_);
  while (waitid(P_PID, id, &ignored, WEXITED | WNOWAIT) < 0 && errno == EINTR) {
  }
  kill(-pid_, SIGKILL);  // what it may have left behind, while its number is still its own
  int status = 0;
  rusage usage{};
  while (wait4(pid_, &status, 0, &usage) < 0 && errno == EINTR) {
  }
  end_ = ExitStatus{.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1,
                    .signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0,
                    .cpu_s = seconds(usage.ru_utime) + seconds(usage.ru_stime)};
  return *end_;
}

ExitStatus ChildProcess::wait() {
  return end_ ? *end_ : reap();
}

std::optional<ExitStatus> ChildProcess::wait_for(std::chrono::milliseconds limit) {
  if (end_) return end_;
  const bool ended =
      wait_until_readable({{descriptor_, POLLIN, 0}}, static_cast<int>(limit.count()));
  if (!ended) return std::nullopt;
  return reap();
}

std::optional<ExitStatus> ChildProcess::wait(const std::stop_token& stop) {
  if (end_) return end_;
  const Descriptor wake(eventfd(0, EFD_CLOEXEC), "eventfd");
  const std::stop_callback on_stop(stop, [&wake] {
    constexpr std::uint64_t kOne = 1;
    [[maybe_unused]] const ssize_t written = write(wake.number(), &kOne, sizeof kOne);
  });
  constexpr int kNoLimit = -1;
  wait_until_readable({{descriptor_, POLLIN, 0}, {wake.number(), POLLIN, 0}}, kNoLimit);
  return wait_for(std::chrono::milliseconds(0));
}

ExitStatus ChildProcess::end(std::chrono::milliseconds grace) {
  signal(SIGTERM);
  if (const auto ended = wait_for(grace)) return *ended;
  signal(SIGKILL);
  return wait();
}

}  // namespace fleetloc
