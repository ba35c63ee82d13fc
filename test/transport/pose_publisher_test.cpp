#include "shared/transport/pose_publisher.hpp"

#include <condition_variable>
#include <mutex>

#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <gtest/gtest.h>
#include <idl/posePubSubTypes.h>

#include "shared/transport/reader_thread.hpp"
#include "test/transport/test_network.hpp"
#include "test/transport/wire_samples.hpp"

namespace fleetloc {
namespace {

TEST(PosePublisher, ReachesALocalReaderOfTheRobotsPartition) {
  const TestNetwork network;
  // "local" ignores the participants of its own process.
  PosePublisher publisher(network.domain(), "robot_1", "loopback");
  Participant consumer(network.domain(), "loopback");
  const auto reader = consumer.create_reader(pose_topic_spec("robot_1"));
  std::mutex mutex;
  std::condition_variable arrived;
  Bytes received;
  const ReaderThread thread({reader.get()}, [&](eprosima::fastdds::dds::DataReader& from) {
    Bytes bytes;
    eprosima::fastdds::dds::SampleInfo info;
    if (from.take_next_sample(&bytes, &info) != ReturnCode_t::RETCODE_OK) return false;
    const std::lock_guard lock(mutex);
    received = bytes;
    arrived.notify_all();
    return true;
  });
  wire::PoseEstimate pose;
  pose.robot("robot_1");
  pose.stamp_ns(17);
  const Bytes sent = to_bytes<wire::PoseEstimatePubSubType>(pose);
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  std::unique_lock lock(mutex);
  while (received.empty() && std::chrono::steady_clock::now() < deadline) {
    EXPECT_TRUE(publisher.publish(sent));
    arrived.wait_for(lock, std::chrono::milliseconds(20));
  }
  EXPECT_EQ(received, sent);
}

TEST(PosePublisher, IsSetUpByTheProfileThatShips) {
  const TestNetwork network;
  PosePublisher publisher(network.domain(), "robot_1");
  EXPECT_EQ(publisher.matched_readers(), 0);
}

}  // namespace
}  // namespace fleetloc
