#include "shared/transport/qos_profiles.hpp"

#include <fstream>

#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "shared/transport/participant.hpp"
#include "shared/transport/workarounds/peer_lookup.hpp"
#include "test/test_folder.hpp"
#include "test/transport/test_network.hpp"

namespace fleetloc {
namespace {

namespace dds = eprosima::fastdds::dds;

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class QosProfilesTest : public testing::Test {
 protected:
  QosProfilesTest() { load_test_profiles(); }

  /// Writes a file of profiles that no other test uses.
  std::filesystem::path written(const std::string& name,
                                const std::string& profiles,
                                const std::string& attributes = "") {
    auto file = test_folder() / name;
    std::ofstream(file) << "<dds" << attributes << "><profiles>" << profiles << "</profiles></dds>";
    return file;
  }

  static std::string refusal(const std::filesystem::path& file) {
    try {
      load_qos_profiles(file);
    } catch (const TransportError& error) {
      return error.what();
    }
    return "no error";
  }
};

std::string participant(const std::string& name, const std::string& rtps) {
  return "<participant profile_name=\"" + name + "\"><rtps>" + rtps + "</rtps></participant>";
}

std::string domain_name(const std::string& profile) {
  dds::DomainParticipantQos qos;
  auto* factory = dds::DomainParticipantFactory::get_instance();
  EXPECT_EQ(factory->get_participant_qos_from_profile(profile, qos), ReturnCode_t::RETCODE_OK);
  return qos.name().to_string();
}

TEST_F(QosProfilesTest, TakeFromTheirBaseWhatTheyDoNotDefine) {
  written("base.xml",
          participant("both", "<name>of base</name>") +
              participant("base_only", "<name>base only</name>"));
  load_qos_profiles(written("over.xml",
                            participant("both", "<name>of over</name>"),
                            " xmlns:fleetloc=\"fleetloc\" fleetloc:based_on=\"base.xml\""));
  EXPECT_EQ(domain_name("both"), "of over");
  EXPECT_EQ(domain_name("base_only"), "base only");
}

std::string discovery(const std::string& elements) {
  return "<builtin><discovery_config>" + elements + "</discovery_config></builtin>";
}
std::string peers(const std::string& address) {
  return "<builtin><initialPeersList><locator><udpv4><address>" + address +
         "</address></udpv4></locator></initialPeersList></builtin>";
}

TEST_F(QosProfilesTest, TakeFromTheProfileOfTheirBaseWhatTheirsDoesNotSay) {
  const std::string timing =
      "<leaseAnnouncement><sec>7</sec></leaseAnnouncement><leaseDuration><sec>70</sec>"
      "</leaseDuration>";
  written("timing_base.xml",
          participant("slow", "<name>base</name>" + discovery(timing)) +
              participant("peered", peers("10.0.0.1")));
  load_qos_profiles(written(
      "timing_over.xml",
      participant("slow", discovery("<leaseAnnouncement><sec>9</sec></leaseAnnouncement>")) +
          participant("peered", peers("10.0.0.2")),
      " xmlns:fleetloc=\"fleetloc\" fleetloc:based_on=\"timing_base.xml\""));
  EXPECT_EQ(domain_name("slow"), "base");
  dds::DomainParticipantQos qos;
  auto* factory = dds::DomainParticipantFactory::get_instance();
  ASSERT_EQ(factory->get_participant_qos_from_profile("slow", qos), ReturnCode_t::RETCODE_OK);
  const auto& times = qos.wire_protocol().builtin.discovery_config;
  EXPECT_EQ(times.leaseDuration_announcementperiod.seconds, 9);
  EXPECT_EQ(times.leaseDuration.seconds, 70);
  ASSERT_EQ(factory->get_participant_qos_from_profile("peered", qos), ReturnCode_t::RETCODE_OK);
  const auto& list = qos.wire_protocol().builtin.initialPeersList;
  ASSERT_EQ(list.size(), 1);
  EXPECT_EQ(eprosima::fastrtps::rtps::IPLocator::toIPv4string(*list.begin()), "10.0.0.2");
}

std::string transport(const std::string& elements) {
  return "<transport_descriptors><transport_descriptor><transport_id>of_test</transport_id>" +
         elements + "</transport_descriptor></transport_descriptors>";
}
std::string interface(const std::string& address) {
  return "<interfaceWhiteList><address>" + address + "</address></interfaceWhiteList>";
}

TEST_F(QosProfilesTest, TakeFromTheTransportOfTheirBaseWhatTheirsDoesNotSay) {
  written("transport_base.xml",
          transport("<type>UDPv4</type><maxMessageSize>5000</maxMessageSize>" +
                    interface("127.0.0.1")) +
              participant("transported",
                          "<userTransports><transport_id>of_test</transport_id></userTransports>"));
  load_qos_profiles(
      written("transport_over.xml",
              transport(interface("127.0.0.2")),
              " xmlns:fleetloc=\"fleetloc\" fleetloc:based_on=\"transport_base.xml\""));
  dds::DomainParticipantQos qos;
  auto* factory = dds::DomainParticipantFactory::get_instance();
  ASSERT_EQ(factory->get_participant_qos_from_profile("transported", qos),
            ReturnCode_t::RETCODE_OK);
  ASSERT_EQ(qos.transport().user_transports.size(), 1U);
  const auto udp = std::dynamic_pointer_cast<eprosima::fastdds::rtps::UDPv4TransportDescriptor>(
      qos.transport().user_transports.front());
  ASSERT_TRUE(udp);
  EXPECT_EQ(udp->maxMessageSize, 5000U);
  EXPECT_THAT(udp->interfaceWhiteList, ElementsAre("127.0.0.2"));
}

TEST_F(QosProfilesTest, RefuseAProfileThatTheirBaseDoesNotHave) {
  written("small_base.xml", participant("of_small_base", ""));
  EXPECT_THAT(
      refusal(written(
          "typo.xml", participant("of_smal_base", ""), " fleetloc:based_on=\"small_base.xml\"")),
      AllOf(HasSubstr("typo.xml"), HasSubstr("line 1")));
  EXPECT_THAT(refusal(written("baseless.xml", "", " fleetloc:based_on=\"nowhere.xml\"")),
              HasSubstr("nowhere.xml: no such file"));
}

TEST_F(QosProfilesTest, NamePeersAndServersByHostsThatNeedNotExistYet) {
  const std::string locators =
      "<locator><udpv4><address>nobody.invalid</address><port>7500</port></udpv4></locator>"
      "<locator><udpv4><address>localhost</address></udpv4></locator>"
      "<locator><udpv4><address>10.1.2.3</address></udpv4></locator>";
  load_qos_profiles(written(
      "named.xml",
      participant("with_peers",
                  "<builtin><initialPeersList>" + locators + "</initialPeersList></builtin>")));
  const NamedPeer nobody{.host = "nobody.invalid", .port = 7500, .server_prefix = {}};
  const NamedPeer here{.host = "localhost", .port = 0, .server_prefix = {}};
  EXPECT_THAT(named_peers("with_peers"), ElementsAre(nobody, here));
  EXPECT_THAT(PeerLookup(named_peers("with_peers")).find(kPatience),
              ElementsAre(ResolvedPeer{.peer = here, .address = "127.0.0.1"}));
  EXPECT_THAT(named_peers("loopback"), IsEmpty());
  dds::DomainParticipantQos qos;
  auto* factory = dds::DomainParticipantFactory::get_instance();
  ASSERT_EQ(factory->get_participant_qos_from_profile("with_peers", qos), ReturnCode_t::RETCODE_OK);
  EXPECT_EQ(qos.wire_protocol().builtin.initialPeersList.size(), 1);  // the address
}

std::string client_of(const std::string& prefix) {
  return "<useBuiltinTransports>false</useBuiltinTransports>"
         "<userTransports><transport_id>loopback</transport_id></userTransports>"
         "<builtin><discovery_config><discoveryProtocol>CLIENT</discoveryProtocol>"
         "<discoveryServersList><RemoteServer prefix=\"" +
         prefix +
         "\"><metatrafficUnicastLocatorList><locator><udpv4><address>nobody.invalid</address>"
         "</udpv4></locator></metatrafficUnicastLocatorList></RemoteServer>"
         "</discoveryServersList></discovery_config></builtin>";
}

TEST_F(QosProfilesTest, LetAParticipantStartWithoutItsDiscoveryServer) {
  const TestNetwork network;
  load_qos_profiles(written(
      "client.xml", participant("client", client_of("44.53.00.5f.45.50.52.4f.53.49.4d.41"))));
  EXPECT_THAT(Participant(network.domain(), "client").peers(), IsEmpty());
  const NamedPeer server = named_peers("client").front();
  const Participant found(network.domain(),
                          "client",
                          nullptr,
                          {.predecessor = {}, .peers = ResolvedPeers{{server, "127.0.0.1"}}});
  EXPECT_EQ(found.peers().size(), 1);
}

}  // namespace
}  // namespace fleetloc
