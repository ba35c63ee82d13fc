#include "deploy/evaluation/experiment/programs.hpp"

#include <chrono>
#include <fstream>
#include <iterator>

#include "deploy/evaluation/experiment/fingerprint.hpp"
#include "deploy/process/child_process.hpp"

namespace fleetloc {
namespace {

std::string last_line(std::string text) {
  while (!text.empty() && (text.back() == '\n' || text.back() == '\r')) text.pop_back();
  return text.substr(text.find_last_of('\n') + 1);
}

}  // namespace

Programs::Programs(const std::filesystem::path& folder) {
  for (const std::string name : {"sim", "map", "replay", "eval", "cloud", "robot"}) {
    const auto file = folder / ("fleetloc-" + name);
    if (!std::filesystem::is_regular_file(file)) {
      throw std::runtime_error(file.string() + ": no such program");
    }
    paths_[name] = file.string();
    fingerprints_[name] = Fingerprint().add_file(name, file).text();
  }
}

const std::string& Programs::path(const std::string& name) const {
  return paths_.at(name);
}

const std::string& Programs::fingerprint(const std::string& name) const {
  return fingerprints_.at(name);
}

void run_program(const std::vector<std::string>& command,
                 const std::filesystem::path& log,
                 const std::stop_token& stop) {
  constexpr std::chrono::seconds kGrace(5);
  if (stop.stop_requested()) throw Interrupted();
  ChildProcess child({.arguments = command, .output = log, .errors = log});
  const auto ended = child.wait(stop);
  if (!ended || stop.stop_requested()) {
    child.end(kGrace);
    throw Interrupted();
  }
  expect_success(command.front(), ended->exit_code, log);
}

void expect_success(const std::string& program, int exit_code, const std::filesystem::path& log) {
  if (exit_code == 0) return;
  const std::string name = std::filesystem::path(program).filename().string();
  const std::string line = last_line(text_of(log));
  throw ProgramFailed(
      line.empty() ? name + " ended with " + std::to_string(exit_code) + ", see " + log.string()
                   : line,
      exit_code);
}

std::string text_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw std::runtime_error(file.string() + ": cannot be read");
  return {std::istreambuf_iterator<char>(stream), {}};
}

void write_text(const std::filesystem::path& file, const std::string& text) {
  std::ofstream stream(file, std::ios::binary);
  stream << text;
  stream.close();
  if (!stream) throw std::runtime_error(file.string() + ": cannot be written");
}

}  // namespace fleetloc
