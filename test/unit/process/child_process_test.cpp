#include "deploy/process/child_process.hpp"

#include <chrono>
#include <csignal>
#include <fstream>
#include <iterator>
#include <system_error>
#include <thread>

#include <gmock/gmock.h>

#include "test/test_folder.hpp"

namespace fleetloc {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr seconds kLong(60);

ChildCommand shell(const std::string& script) {
  return {.arguments = {"/bin/sh", "-c", script},
          .output = test_folder() / "output",
          .errors = test_folder() / "errors"};
}

std::string text_of(const char* name) {
  std::ifstream stream(test_folder() / name);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// Waits until the child has written a line: the number of a process.
pid_t printed_process(ChildProcess& child) {
  while (text_of("output").find('\n') == std::string::npos) {
    if (child.wait_for(milliseconds(1))) return -1;
  }
  return std::stoi(text_of("output"));
}

TEST(ChildProcess, TellsTheExitCodeAndKeepsBothStreams) {
  ChildProcess child(shell("echo out; echo err >&2; exit 7"));
  EXPECT_EQ(child.wait().exit_code, 7);
  EXPECT_EQ(child.wait().exit_code, 7);
  EXPECT_EQ(text_of("output"), "out\n");
  EXPECT_EQ(text_of("errors"), "err\n");
}

TEST(ChildProcess, TellsTheSignalThatEndedIt) {
  ChildProcess child(shell("kill -SEGV $$"));
  const ExitStatus end = child.wait();
  EXPECT_EQ(end.exit_code, -1);
  EXPECT_EQ(end.signal, SIGSEGV);
}

TEST(ChildProcess, IsRefusedIfThereIsNoSuchProgram) {
  ChildCommand command = shell("");
  command.arguments = {"/no/such/program"};
  EXPECT_THROW(ChildProcess{command}, std::system_error);
}

TEST(ChildProcess, StopsWaitingWhenAStopIsRequested) {
  ChildProcess child(shell("sleep 60"));
  std::stop_source stop;
  std::jthread stopper([&stop] { stop.request_stop(); });
  EXPECT_FALSE(child.wait(stop.get_token()));
  EXPECT_EQ(child.end(kLong).signal, SIGTERM);
}

TEST(ChildProcess, IsKilledIfItDoesNotMindTheEndOfItsGrace) {
  ChildProcess child(shell("trap '' TERM; echo 1; while :; do sleep 60; done"));
  ASSERT_EQ(printed_process(child), 1);
  EXPECT_EQ(child.end(milliseconds(20)).signal, SIGKILL);
}

TEST(ChildProcess, LeavesNoGrandchildBehind) {
  pid_t grandchild = -1;
  {
    ChildProcess child(shell("sleep 60 & echo $!; wait"));
    grandchild = printed_process(child);
    ASSERT_GT(grandchild, 0);
  }
  const auto deadline = std::chrono::steady_clock::now() + kLong;
  const auto state = [grandchild] {  // Z until somebody has taken note
    std::ifstream stat("/proc/" + std::to_string(grandchild) + "/stat");
    std::string number;
    std::string name;
    std::string letter;
    stat >> number >> name >> letter;
    return letter;
  };
  while (!state().empty() && state() != "Z" && std::chrono::steady_clock::now() < deadline) {
    std::this_thread::yield();
  }
  EXPECT_THAT(state(), testing::AnyOf("", "Z"));
}

TEST(ChildProcess, TakesNoBlockedSignalsOver) {
  sigset_t blocked;
  sigset_t before;
  sigemptyset(&blocked);
  sigaddset(&blocked, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &blocked, &before);
  ChildProcess child(shell("sleep 60"));
  EXPECT_EQ(child.end(kLong).signal, SIGTERM);
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

}  // namespace
}  // namespace fleetloc
