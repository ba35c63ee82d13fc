#include "deploy/replay/sample_recorder.hpp"

#include <stdexcept>
#include <string_view>
#include <utility>

namespace fleetloc {
namespace {

// As in the topics' names; see idl/README.md.
std::string_view name(Topic topic) {
  switch (topic) {
    case Topic::kSession:
      return "session";
    case Topic::kSubmap:
      return "full_submap";
    case Topic::kCompactSubmap:
      return "submap";
    case Topic::kLocalization:
      return "localization";
    case Topic::kRobotStatus:
      return "robot_status";
    case Topic::kLocalizerStatus:
      return "localizers";
  }
  return "";
}

}  // namespace

SampleRecorder::SampleRecorder(std::unique_ptr<Channel> inner, const std::filesystem::path& file)
    : inner_(std::move(inner)), stream_(file) {
  if (!stream_) throw std::runtime_error(file.string() + ": cannot be written");
}

void SampleRecorder::send(const std::string& partition, Message message, Timestamp now) {
  write(message);
  inner_->send(partition, std::move(message), now);
}

std::vector<Message> SampleRecorder::receive(Timestamp now) {
  std::vector<Message> messages = inner_->receive(now);
  for (const Message& message : messages) write(message);
  return messages;
}

void SampleRecorder::write(const Message& message) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string line(name(message.topic));
  line += ' ';
  for (const std::uint8_t byte : message.payload) {
    line += kDigits[byte >> 4U];
    line += kDigits[byte & 15U];
  }
  stream_ << line << '\n';
}

}  // namespace fleetloc
