#include "deploy/topic/topic_table.hpp"

#include <algorithm>
#include <cstdio>

namespace fleetloc {
namespace {

std::string padded(std::string text, std::size_t width) {
  text.resize(std::max(text.size(), width), ' ');
  return text;
}

std::string decimal(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.1f", value);
  return text;
}

}  // namespace

std::string topic_table(const std::vector<ObservedTopic>& topics,
                        const std::map<std::string, HeardTraffic>& heard,
                        std::optional<double> listened_s) {
  std::vector<std::vector<std::string>> lines{
      {"topic", "type", "writers", "readers", "samples/s", "bytes/s"}};
  for (const ObservedTopic& topic : topics) {
    std::vector<std::string> line{
        topic.name, topic.type, std::to_string(topic.writers), std::to_string(topic.readers)};
    const auto traffic = heard.find(topic.name);
    if (listened_s && traffic != heard.end()) {
      line.push_back(decimal(static_cast<double>(traffic->second.samples) / *listened_s));
      line.push_back(decimal(static_cast<double>(traffic->second.bytes) / *listened_s));
    } else {
      line.insert(line.end(), {"-", "-"});
    }
    lines.push_back(std::move(line));
  }
  std::string out;
  for (const auto& line : lines) {
    std::string text;
    for (std::size_t i = 0; i < line.size(); ++i) {
      std::size_t width = 0;
      for (const auto& other : lines) width = std::max(width, other[i].size());
      text += i + 1 < line.size() ? padded(line[i], width + 2) : line[i];
    }
    out += text + "\n";
  }
  return out;
}

bool is_meant(std::string_view wanted, std::string_view topic) {
  if (wanted.empty() || wanted == topic) return true;
  return topic.size() > wanted.size() && topic.ends_with(wanted) &&
         topic[topic.size() - wanted.size() - 1] == '/';
}

}  // namespace fleetloc
