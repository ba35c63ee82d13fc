#include "test/system/run_watch.hpp"

#include <fstream>
#include <map>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <thread>

namespace fleetloc {
namespace {

using Line = std::map<std::string, std::string>;  // by the names of the columns

std::vector<std::string> fields_of(const std::string& line) {
  std::vector<std::string> fields;
  std::istringstream stream(line);
  for (std::string field; std::getline(stream, field, ',');) fields.push_back(field);
  return fields;
}

std::vector<Line> lines_of(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::vector<Line> lines;
  std::vector<std::string> names;
  for (std::string text; std::getline(stream, text) && !stream.eof();) {  // whole lines only
    const std::vector<std::string> fields = fields_of(text);
    if (names.empty()) {
      names = fields;
      continue;
    }
    Line& line = lines.emplace_back();
    for (std::size_t i = 0; i < fields.size() && i < names.size(); ++i) line[names[i]] = fields[i];
  }
  return lines;
}

// "seconds.nanoseconds", exactly.
Timestamp stamp_from(const std::string& text) {
  const auto point = text.find('.');
  return Timestamp(std::chrono::seconds(std::stoll(text.substr(0, point))) +
                   std::chrono::nanoseconds(std::stoll(text.substr(point + 1))));
}

}  // namespace

std::vector<FrameLine> frames_of(const std::filesystem::path& run) {
  std::vector<FrameLine> frames;
  for (Line& line : lines_of(run / "diagnostics.csv")) {
    frames.push_back({.stamp = stamp_from(line.at("stamp_s")),
                      .state = line.at("state"),
                      .keyframe = line.at("keyframe") == "1"});
  }
  return frames;
}

std::vector<AnswerLine> answers_of(const std::filesystem::path& run) {
  std::vector<AnswerLine> answers;
  for (Line& line : lines_of(run / "answers.csv")) {
    answers.push_back({.stamp = stamp_from(line.at("stamp_s")),
                       .arrival = stamp_from(line.at("arrival_s")),
                       .localizer = line.at("localizer"),
                       .applied = line.at("applied") == "1"});
  }
  return answers;
}

Timestamp wait_for_data(const std::filesystem::path& run,
                        std::chrono::duration<double> data,
                        std::chrono::seconds patience) {
  const auto deadline = std::chrono::steady_clock::now() + patience;
  while (std::chrono::steady_clock::now() < deadline) {
    const std::vector<FrameLine> frames = frames_of(run);
    if (!frames.empty() && frames.back().stamp - frames.front().stamp >= data) {
      return frames.back().stamp;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  throw std::runtime_error(run.string() + ": the run does not go on");
}

}  // namespace fleetloc
