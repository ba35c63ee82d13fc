// Programs of two versions of the wire share no topic, and are to say so. The others are bare
// participants.
#include "shared/transport/wire_version.hpp"

#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "test/system/network_namespace.hpp"
#include "test/transport/discovery_server.hpp"
#include "test/transport/test_network.hpp"

namespace fleetloc {
namespace {

namespace dds = eprosima::fastdds::dds;

using testing::Contains;
using testing::HasSubstr;

constexpr const char* kComplaint = "a program (fleetloc-test) has version 3 of the wire";

/// A program of a later version: of it is known only that it says so, and has the common topic.
class LaterProgram {
 public:
  LaterProgram(std::uint32_t domain, const std::string& profile) {
    auto* factory = dds::DomainParticipantFactory::get_instance();
    dds::DomainParticipantQos qos;
    factory->get_participant_qos_from_profile(profile, qos);
    const std::string version = wire_version_text(3);
    qos.user_data().setValue({version.begin(), version.end()});
    for (const NamedPeer& peer : named_peers(profile)) {
      eprosima::fastdds::rtps::RemoteServerAttributes server;
      server.ReadguidPrefix(peer.server_prefix.c_str());
      eprosima::fastrtps::rtps::Locator_t locator;
      eprosima::fastrtps::rtps::IPLocator::createLocator(
          LOCATOR_KIND_UDPv4, peer.host, peer.port, locator);
      server.metatrafficUnicastLocatorList.push_back(locator);
      qos.wire_protocol().builtin.discovery_config.m_DiscoveryServers.push_back(server);
    }
    participant_.reset(factory->create_participant(domain, qos));
    const TopicSpec spec = versions_topic_spec();
    spec.type.register_type(participant_.get());
    topic_ =
        participant_->create_topic(spec.name, spec.type.get_type_name(), dds::TOPIC_QOS_DEFAULT);
  }

  void be_a_localizer() {
    participant_->create_publisher(dds::PUBLISHER_QOS_DEFAULT)
        ->create_datawriter(topic_, dds::DATAWRITER_QOS_DEFAULT);
  }
  void be_a_robot() {
    participant_->create_subscriber(dds::SUBSCRIBER_QOS_DEFAULT)
        ->create_datareader(topic_, dds::DATAREADER_QOS_DEFAULT);
  }

 private:
  EntityPtr<dds::DomainParticipant> participant_;
  dds::Topic* topic_ = nullptr;
};

bool complains(DdsChannel& channel) {
  return comes_true([&] {
    const auto events = channel.take_events();
    return testing::Matches(Contains(HasSubstr(kComplaint)))(events);
  });
}

TEST(WireVersion, OfEveryOtherProgramIsSeenWherePeersAnnounceThemselves) {
  const TestNetwork network;
  DdsChannel robot(on_loopback(network.domain(), ChannelRole::kRobot, "robot_1"));
  const LaterProgram other(network.domain(), "loopback");
  EXPECT_TRUE(complains(robot));
}

TEST(WireVersion, IsToldByADiscoveryServerToTheRobotAndToTheLocalizerThatDoNotMatch) {
  if (const auto reason = NetworkNamespace::why_impossible()) GTEST_SKIP() << *reason;
  if (const auto reason = DiscoveryServer::why_impossible()) GTEST_SKIP() << *reason;
  const TestNetwork network;
  NetworkNamespace computer;
  const auto inside = computer.enter();
  const DiscoveryServer server;
  const auto channel = [&](ChannelRole role, const std::string& name) {
    auto end = on_loopback(network.domain(), role, name);
    end.participant_profile = "loopback_client";
    return end;
  };
  {
    DdsChannel robot(channel(ChannelRole::kRobot, "robot_1"));
    LaterProgram localizer(network.domain(), "loopback_client");
    localizer.be_a_localizer();
    EXPECT_TRUE(complains(robot));
  }
  DdsChannel localizer(channel(ChannelRole::kCloud, "cloud_1"));
  LaterProgram robot(network.domain(), "loopback_client");
  robot.be_a_robot();
  EXPECT_TRUE(complains(localizer));
}

}  // namespace
}  // namespace fleetloc
