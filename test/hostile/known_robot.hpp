#pragma once

#include <algorithm>
#include <cstdint>
#include <string>

#include <gtest/gtest.h>

#include "test/transport/intruder.hpp"
#include "test/transport/test_network.hpp"
#include "test/transport/wire_samples.hpp"

namespace fleetloc {

/// robot_1, which sends submaps to cloud_1, and what others may say in its name.
class KnownRobot {
 public:
  static constexpr std::uint32_t kForged = 1000;  ///< numbers of submaps from there on

  KnownRobot(std::uint32_t domain,
             const std::string& profile,
             const ParticipantOptions& options = {})
      : robot_(domain, profile, nullptr, options) {}

  /// The next one is received, and none that is forged.
  bool next_submap_arrives(DdsChannel& cloud) {
    const std::uint32_t next = ++number_;
    return receives(
        cloud,
        [&] { write(next); },
        [&](const Message& message) {
          EXPECT_LT(number_of(message), kForged);
          return number_of(message) == next;
        });
  }

  void write(std::uint32_t number) {
    Bytes submap = numbered_submap(number).payload;
    writer_->write(&submap);
  }
  /// Of the latest submap that arrived.
  [[nodiscard]] std::uint32_t number() const { return number_; }

  eprosima::fastdds::dds::DataWriter& writer() { return *writer_; }
  [[nodiscard]] std::uint32_t writer_id() const {
    std::uint32_t id = 0;
    for (const auto byte : writer_->guid().entityId.value) id = id << 8U | byte;
    return id;
  }
  [[nodiscard]] GuidPrefix prefix() const {
    GuidPrefix prefix{};
    std::ranges::copy(writer_->guid().guidPrefix.value, prefix.begin());
    return prefix;
  }
  [[nodiscard]] Bytes guid() const {
    const GuidPrefix own = prefix();
    return ByteWriter().bytes({own.begin(), own.end()}).entity(0x1c1).written();
  }

  /// A submap as if the robot had written it as its sample of that number.
  [[nodiscard]] Bytes forged_submap(std::uint64_t sequence_number) const {
    ByteWriter body;
    body.u16(0).u16(16).entity(0).entity(writer_id()).sequence_number(sequence_number);
    body.bytes(numbered_submap(kForged).payload);
    return message_of({submessage(0x15, 1 | 4, body.written())}, prefix());
  }
  /// @param says  who says that it leaves
  [[nodiscard]] Bytes leaves(const GuidPrefix& says) const {
    ByteWriter body;
    body.u16(0).u16(16).entity(0).entity(kParticipantWriter).sequence_number(500);
    body.u16(0x70).u16(16).bytes(guid());
    body.u16(0x71).u16(4).bytes({0, 0, 0, 3}).u16(1).u16(0);
    return message_of({submessage(0x15, 1 | 2, body.written())}, says);
  }

 private:
  Participant robot_;
  EntityPtr<eprosima::fastdds::dds::DataWriter> writer_ =
      robot_.create_writer(topic_spec(Topic::kSubmap, "cloud_1"));
  std::uint32_t number_ = 0;
};

}  // namespace fleetloc
