#pragma once

#include <filesystem>
#include <string>

#include "deploy/evaluation/experiment/programs.hpp"
#include "test/unit/experiment/plan_files.hpp"

namespace fleetloc {

/// Scripts in place of the programs: their arguments are logged in `calls`, and a run folder gets
/// just the files that results are read from.
inline Programs fake_programs(const std::string& replay_ends = "exit 0") {
  const std::string calls = (test_folder() / "calls").string();
  const std::string log = "#!/bin/sh\necho \"$(basename $0) $*\" >> " + calls + "\n";
  const std::string find_out =
      "while [ $# -gt 0 ]; do case $1 in --out|--run) out=$2 ;; esac; shift; done\n";
  for (const char* name : {"sim", "map", "cloud", "robot"}) {
    write(std::string("bin/fleetloc-") + name, log);
  }
  write("bin/fleetloc-eval",
        log + "[ $3 = --pose-at-ns ] && echo 1 2 3 0 0 0 1 && exit\n" + find_out +
            "echo '{\"ate\": {\"median\": 0.25, \"max\": 1}, \"covered\": 0.75}' > "
            "$out/evaluation.json\n");
  write("bin/fleetloc-replay",
        log + find_out + "echo '{\"coverage\": 0.5, \"resets\": null}' > $out/summary.json\n" +
            "echo '{\"robot\": {\"optimize_ms\": {\"p50\": 7}}}' > $out/sessions.json\n" +
            replay_ends + "\n");
  for (const auto& entry : std::filesystem::directory_iterator(test_folder() / "bin")) {
    std::filesystem::permissions(entry.path(), std::filesystem::perms::owner_all);
  }
  return Programs(test_folder() / "bin");
}

}  // namespace fleetloc
