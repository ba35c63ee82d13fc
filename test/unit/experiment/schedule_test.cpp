#include "deploy/evaluation/experiment/schedule.hpp"

#include <atomic>
#include <latch>
#include <set>
#include <stdexcept>

#include <gmock/gmock.h>

#include "deploy/evaluation/experiment/programs.hpp"
#include "test/test_folder.hpp"

namespace fleetloc {
namespace {

const TaskEnded kIgnored = [](const Task&, const std::string&) {};

Task program(const std::string& path) {
  return {path, [path](const std::stop_token& stop, int slot) {
            run_program({path}, test_folder() / ("log" + std::to_string(slot)), stop);
            return std::string("done");
          }};
}

TEST(Schedule, RunsEveryTaskOnce) {
  std::vector<Task> tasks(9, program("/bin/true"));
  std::size_t ended = 0;
  run_tasks(tasks, 4, {}, [&ended](const Task&, const std::string& line) {
    EXPECT_EQ(line, "done");
    ++ended;
  });
  EXPECT_EQ(ended, tasks.size());
}

TEST(Schedule, RunsAsManyAtOnceAsThereAreJobs) {
  std::latch all(3);
  std::mutex mutex;
  std::set<int> slots;
  const Task task{"", [&](const std::stop_token&, int slot) {
                    const std::scoped_lock lock(mutex);
                    slots.insert(slot);
                    return std::string();
                  }};
  const Task meeting{"", [&](const std::stop_token& stop, int slot) {
                       all.arrive_and_wait();  // ends only if all three run at once
                       return task.run(stop, slot);
                     }};
  run_tasks({meeting, meeting, meeting}, 3, {}, kIgnored);
  EXPECT_THAT(slots, testing::ElementsAre(0, 1, 2));
}

TEST(Schedule, EndsRunningChildrenAtAStop) {
  std::stop_source stop;
  const Task sleeper{"", [](const std::stop_token& token, int) {
                       run_program({"/bin/sleep", "60"}, test_folder() / "sleep", token);
                       return std::string();
                     }};
  const Task stopper{"", [&stop](const std::stop_token&, int) {
                       stop.request_stop();
                       return std::string("stopped");
                     }};
  std::vector<std::string> lines;
  run_tasks({sleeper, stopper, program("/bin/true")},
            2,
            stop.get_token(),
            [&lines](const Task&, const std::string& line) { lines.push_back(line); });
  EXPECT_THAT(lines, testing::ElementsAre("stopped"));
}

TEST(Schedule, StopsTheOthersAndTellsWhenOneFails) {
  const Task sleeper{"", [](const std::stop_token& token, int) {
                       run_program({"/bin/sleep", "60"}, test_folder() / "sleep", token);
                       return std::string();
                     }};
  EXPECT_THROW(run_tasks({sleeper, program("/bin/false")}, 2, {}, kIgnored), ProgramFailed);
}

TEST(RunProgram, TellsTheLastLineOfAFailure) {
  try {
    run_program({"/bin/sh", "-c", "echo first; echo last >&2; exit 3"}, test_folder() / "log", {});
    FAIL();
  } catch (const ProgramFailed& error) {
    EXPECT_STREQ(error.what(), "last");
    EXPECT_EQ(error.exit_code(), 3);
  }
}

}  // namespace
}  // namespace fleetloc
