#include "shared/transport/ros2/ros2_participant.hpp"

#include <algorithm>
#include <optional>

#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/rtps/transport/UDPTransportDescriptor.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "shared/core/boot_time.hpp"
#include "shared/transport/qos_profiles.hpp"
#include "test/transport/ros2_network.hpp"
#include "test/transport/test_network.hpp"

namespace fleetloc {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr std::size_t kImageBytes = 752 * 480;
constexpr std::size_t kRoom = 100;

Ros2Topic images(Ros2Qos qos) {
  return {.name = "rt/camera/left/image_raw", .type = "sensor_msgs::msg::dds_::Image_", .qos = qos};
}
Ros2Topic imu(Ros2Qos qos) {
  return {.name = "rt/imu", .type = "sensor_msgs::msg::dds_::Imu_", .qos = qos};
}

/// Not the CDR of anything: a participant does not look into it.
Bytes message(std::uint8_t number, std::size_t bytes = 64, std::uint8_t byte_order = 1) {
  Bytes message(bytes, number);
  std::ranges::copy(Bytes{0, byte_order, 0, 0}, message.begin());
  return message;
}

/// The next sample, however long it takes.
std::optional<Ros2Sample> next(Ros2Reader& reader) {
  return reader.take({}, kPatience);
}

class Ros2ParticipantTest : public testing::Test {
 protected:
  const Ros2Network network_;
  Ros2Participant driver_{network_.domain()};
  Ros2Participant robot_{network_.domain()};
};

TEST_F(Ros2ParticipantTest, CarriesWholeImagesByEitherQosToAReaderForSensorData) {
  for (const Ros2Qos qos : {Ros2Qos::kSensorData, Ros2Qos::kDefault}) {
    Ros2Reader robot(robot_, {{images(Ros2Qos::kSensorData), kRoom}});
    Ros2Writer camera = driver_.create_writer(images(qos));
    ASSERT_TRUE(comes_true([&] { return camera.matched_readers() == 1; }));
    ASSERT_TRUE(comes_true([&] { return robot.matched_writers(0) == 1; }));
    const Bytes sent = message(7, kImageBytes);
    const ArrivalTime before = boot_time();
    EXPECT_TRUE(camera.write(sent));
    const auto received = next(robot);
    ASSERT_TRUE(received);
    EXPECT_EQ(received->payload, sent);
    EXPECT_GE(received->arrival, before);
    EXPECT_LE(received->arrival, boot_time());
  }
}

TEST_F(Ros2ParticipantTest, RepeatsWhatIsLostOfImagesThatComeAllAtOnce) {
  constexpr std::uint8_t kImages = 40;
  Ros2Reader robot(robot_, {{images(Ros2Qos::kDefault), kRoom}});
  Ros2Writer camera = driver_.create_writer(images(Ros2Qos::kDefault));
  ASSERT_TRUE(comes_true([&] { return camera.matched_readers() == 1; }));
  for (std::uint8_t i = 0; i < kImages; ++i) {
    ASSERT_TRUE(camera.write(message(i, kImageBytes)));
  }
  EXPECT_TRUE(camera.wait_for_acknowledgments(kPatience));
  for (std::uint8_t i = 0; i < kImages; ++i) {
    const auto received = next(robot);
    ASSERT_TRUE(received);
    ASSERT_EQ(received->payload, message(i, kImageBytes)) << int{i};
  }
}

TEST_F(Ros2ParticipantTest, TellsTopicsApartAndLetsBothByteOrdersThrough) {
  Ros2Reader robot(robot_, {{imu(Ros2Qos::kDefault), kRoom}, {images(Ros2Qos::kDefault), kRoom}});
  Ros2Writer camera = driver_.create_writer(images(Ros2Qos::kDefault));
  Ros2Writer unit = driver_.create_writer(imu(Ros2Qos::kDefault));
  ASSERT_TRUE(
      comes_true([&] { return camera.matched_readers() == 1 && unit.matched_readers() == 1; }));
  constexpr std::uint8_t kBigEndian = 0;
  camera.write(message(1, 64, kBigEndian));
  const auto image = next(robot);
  ASSERT_TRUE(image);
  EXPECT_EQ(image->topic, 1);
  EXPECT_EQ(image->payload, message(1, 64, kBigEndian));
  unit.write(message(2));
  const auto sample = next(robot);
  ASSERT_TRUE(sample);
  EXPECT_EQ(sample->topic, 0);
  EXPECT_EQ(sample->payload, message(2));
}

TEST_F(Ros2ParticipantTest, GivesALatchedMessageToThoseWhoComeLater) {
  const Ros2Topic topic{"rt/map", "sensor_msgs::msg::dds_::PointCloud2_", Ros2Qos::kLatched};
  Ros2Writer map = driver_.create_writer(topic);
  map.write(message(1));
  map.write(message(2));
  Ros2Reader viewer(robot_, {{topic, kRoom}});
  const auto received = next(viewer);
  ASSERT_TRUE(received);
  EXPECT_EQ(received->payload, message(2));
}

TEST_F(Ros2ParticipantTest, DoesNotReadReliablyFromABestEffortWriter) {
  Ros2Reader robot(robot_, {{imu(Ros2Qos::kSensorData), kRoom}});
  Ros2Reader other(robot_, {{imu(Ros2Qos::kDefault), kRoom}});
  Ros2Writer reliable = driver_.create_writer(imu(Ros2Qos::kDefault));
  ASSERT_TRUE(comes_true([&] { return reliable.matched_readers() == 2; }));
  const Ros2Writer best_effort = driver_.create_writer(imu(Ros2Qos::kSensorData));
  ASSERT_TRUE(comes_true([&] { return best_effort.matched_readers() == 1; }));
  ASSERT_TRUE(comes_true([&] { return robot.matched_writers(0) == 2; }));
  EXPECT_EQ(other.matched_writers(0), 1);
}

TEST_F(Ros2ParticipantTest, CountsWhatNobodyTakesAndKeepsTheNewest) {
  Ros2Reader robot(robot_, {{imu(Ros2Qos::kDefault), 1}});
  Ros2Writer unit = driver_.create_writer(imu(Ros2Qos::kDefault));
  ASSERT_TRUE(comes_true([&] { return unit.matched_readers() == 1; }));
  for (std::uint8_t number = 1; number <= 3; ++number) unit.write(message(number));
  EXPECT_TRUE(comes_true([&] { return robot.dropped(0) == 2; }));
  const auto newest = next(robot);
  ASSERT_TRUE(newest);
  EXPECT_EQ(newest->payload, message(3));
}

TEST_F(Ros2ParticipantTest, RefusesADomainThatDoesNotExist) {
  EXPECT_THROW(Ros2Participant(101), TransportError);
}

TEST(Ros2Profiles, BindToLoopbackAlone) {
  const Ros2Network network;
  namespace dds = eprosima::fastdds::dds;
  dds::DomainParticipantQos qos;
  auto* factory = dds::DomainParticipantFactory::get_instance();
  ASSERT_EQ(factory->get_participant_qos_from_profile("ros2", qos), ReturnCode_t::RETCODE_OK);
  EXPECT_FALSE(qos.transport().use_builtin_transports);
  ASSERT_EQ(qos.transport().user_transports.size(), 1);
  const auto udp = std::dynamic_pointer_cast<eprosima::fastdds::rtps::UDPTransportDescriptor>(
      qos.transport().user_transports.front());
  ASSERT_TRUE(udp);
  EXPECT_THAT(udp->interfaceWhiteList, ElementsAre("127.0.0.1"));
}

TEST(Ros2Profiles, AreOnceInAProcess) {
  const Ros2Network network;
  try {
    load_ros2_profiles();  // those that are built in have the same names
    FAIL() << "no error";
  } catch (const TransportError& error) {
    EXPECT_THAT(error.what(), HasSubstr("ros2.xml of this program"));
  }
}

}  // namespace
}  // namespace fleetloc
