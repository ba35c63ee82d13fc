#pragma once

#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "shared/link/channel.hpp"

namespace fleetloc {

/// A robot's end of the network that writes down what is sent and received through it: a line per
/// sample, the name of its topic and its bytes in hexadecimal.
class SampleRecorder final : public Channel {
 public:
  /// Throws std::runtime_error if the file cannot be written.
  SampleRecorder(std::unique_ptr<Channel> inner, const std::filesystem::path& file);

  void send(const std::string& partition, Message message, Timestamp now) override;
  [[nodiscard]] std::vector<Message> receive(Timestamp now) override;
  [[nodiscard]] ChannelStatistics statistics() const override { return inner_->statistics(); }
  void prepare(const std::string& partition) override { inner_->prepare(partition); }
  void release(const std::string& partition) override { inner_->release(partition); }

 private:
  void write(const Message& message);

  std::unique_ptr<Channel> inner_;
  std::ofstream stream_;
};

}  // namespace fleetloc
