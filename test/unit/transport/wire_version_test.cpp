#include "shared/transport/wire_version.hpp"

#include <random>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "shared/transport/workarounds/datagram_check.hpp"
#include "test/transport/rtps_messages.hpp"

namespace fleetloc {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::uint16_t kUserData = 0x002c;
constexpr std::uint16_t kParticipantGuid = 0x0050;
constexpr std::uint16_t kEntityName = 0x0062;

// A parameter with a length before its octets, as user data and names have it.
void add_counted(ByteWriter& list, std::uint16_t id, const std::string& text) {
  const std::size_t padded = (text.size() + 3) / 4 * 4;
  list.u16(id).u16(4 + padded).u32(text.size()).bytes({text.begin(), text.end()});
  list.zeros(padded - text.size());
}

Bytes announcement_of(const std::string& name,
                      const std::string& user_data,
                      const GuidPrefix& participant = {}) {
  ByteWriter body;
  body.u16(0).u16(16).entity(0).entity(kParticipantWriter).sequence_number(1);
  body.bytes({0, 3, 0, 0});
  body.u16(kParticipantGuid).u16(16).bytes({participant.begin(), participant.end()}).entity(0x1c1);
  add_counted(body, kEntityName, name + '\0');
  if (!user_data.empty()) add_counted(body, kUserData, user_data);
  body.u16(1).u16(0);
  return message_of({submessage(0x15, 1 | 4, body.written())});
}

TEST(AnnouncesRobot, KnowsARobotThatSpeaksForItself) {
  const std::string robot = wire_version_text(ChannelRole::kRobot);
  const std::string localizer = wire_version_text(ChannelRole::kCloud);
  const GuidPrefix sender = sender_of(announcement_of("", ""));
  GuidPrefix other = sender;
  ++other[0];
  EXPECT_TRUE(announces_robot(announcement_of("robot", robot, sender)));
  EXPECT_FALSE(announces_robot(announcement_of("robot", robot, other))) << "by a discovery server";
  EXPECT_FALSE(announces_robot(announcement_of("cloud", localizer, sender)));
  EXPECT_FALSE(announces_robot(announcement_of("fleetloc-robot", "", sender)));
}

class WireVersionWatchTest : public testing::Test {
 protected:
  std::vector<std::string> events(const std::string& name, const std::string& user_data) {
    watch_.observe(announcement_of(name, user_data));
    return watch_.take_events();
  }

  WireVersionWatch watch_{2};
};

TEST_F(WireVersionWatchTest, NamesEachProgramOfAnotherVersionOnce) {
  EXPECT_THAT(events("fleetloc-cloud", wire_version_text(3)),
              ElementsAre("a program (fleetloc-cloud) has version 3 of the wire, this one 2: they "
                          "do not hear each other"));
  EXPECT_THAT(events("fleetloc-cloud", wire_version_text(3)), IsEmpty());
  EXPECT_THAT(events("fleetloc-robot", wire_version_text(3)),
              ElementsAre(HasSubstr("fleetloc-robot")));
  EXPECT_THAT(events("fleetloc-cloud", wire_version_text(1)), ElementsAre(HasSubstr("version 1")));
}

TEST_F(WireVersionWatchTest, TakesOneThatSaysNothingForAProgramFromBeforeTheFirst) {
  EXPECT_THAT(events("fleetloc-robot", ""), ElementsAre(HasSubstr("version 0")));
}

TEST_F(WireVersionWatchTest, SaysNothingOfItsOwnVersionAndOfStrangers) {
  EXPECT_THAT(events("fleetloc-cloud", wire_version_text(2)), IsEmpty());
  EXPECT_THAT(events("eProsima Default Server number 0", ""), IsEmpty());
  EXPECT_THAT(events("talker", "enclave=/;"), IsEmpty());
}

TEST_F(WireVersionWatchTest, PutsNoNameIntoALogThatIsNotOne) {
  EXPECT_THAT(events("fleetloc\n[error] all is lost", ""),
              ElementsAre(HasSubstr("(of an odd name)")));
}

TEST_F(WireVersionWatchTest, StaysQuietWhoeverComes) {
  std::size_t lines = 0;
  for (int i = 0; i < 1000; ++i) lines += events("fleetloc", wire_version_text(10 + i)).size();
  EXPECT_EQ(lines, 16);
}

TEST_F(WireVersionWatchTest, LivesThroughEverythingThatPassesTheCheck) {
  std::mt19937 random(1);
  for (int i = 0; i < 20'000; ++i) {
    Bytes message = i % 2 == 0 ? random_message(random)
                               : announcement_of("fleetloc-cloud", wire_version_text(3));
    if (message.size() <= kRtpsHeaderBytes) continue;
    for (int n = 0; n < 3; ++n) {
      message[kRtpsHeaderBytes + random() % (message.size() - kRtpsHeaderBytes)] =
          static_cast<std::uint8_t>(random());
    }
    if (check_rtps(message)) watch_.observe(message);
  }
}

TEST_F(WireVersionWatchTest, MayBeAskedWhileOthersObserve) {  // for ThreadSanitizer
  const Bytes message = announcement_of("fleetloc-cloud", wire_version_text(3));
  const auto observe = [&] {
    for (int i = 0; i < 1000; ++i) watch_.observe(message);
  };
  std::size_t lines = 0;
  {
    const std::jthread first(observe);
    const std::jthread second(observe);
    for (int i = 0; i < 100; ++i) lines += watch_.take_events().size();
  }
  EXPECT_EQ(lines + watch_.take_events().size(), 1);
}

}  // namespace
}  // namespace fleetloc
