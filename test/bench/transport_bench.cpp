// What the transport adds to each datagram and to each sample, and what a sample costs over DDS.
#include <array>
#include <chrono>
#include <memory>

#include <benchmark/benchmark.h>
#include <fastdds/rtps/common/LocatorSelector.hpp>
#include <fastdds/rtps/network/SenderResource.h>
#include <fastdds/rtps/transport/ChainingTransport.h>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>

#include "shared/compact/answer_sample.hpp"
#include "shared/compact/submap_sample.hpp"
#include "shared/transport/topics.hpp"
#include "shared/transport/wire_transport.hpp"
#include "shared/transport/workarounds/route_cache.hpp"
#include "shared/wire/session_codec.hpp"
#include "shared/wire/status_codec.hpp"
#include "shared/wire/submap_codec.hpp"
#include "test/transport/rtps_messages.hpp"
#include "test/transport/test_network.hpp"
#include "test/transport/wire_samples.hpp"
#include "test/unit/compact/moving_robot.hpp"
#include "test/unit/wire/samples.hpp"

namespace fleetloc {
namespace {

namespace fdr = eprosima::fastdds::rtps;
namespace rtps = eprosima::fastrtps::rtps;

constexpr GuidPrefix kPeer{1, 15, 7};
constexpr std::uint32_t kPort = 7411;

rtps::Locator_t locator_at(int host) {
  rtps::Locator_t locator;
  const std::string address = "127.0.0." + std::to_string(host);
  rtps::IPLocator::createLocator(LOCATOR_KIND_UDPv4, address, kPort, locator);
  return locator;
}

/// A sample of 1200 bytes to one reader, as Fast DDS sends it.
Bytes one_datagram() {
  ByteWriter data;
  data.u16(0).u16(16).entity(0).entity(0x102).sequence_number(2).bytes({0, 1, 0, 0}).zeros(1196);
  return message_of({submessage(0x0e, 1, Bytes(12)),
                     submessage(0x09, 1, Bytes(8)),
                     submessage(0x15, 1 | 4, data.written()),
                     submessage(0x80, 1, Bytes(56))},
                    kPeer);
}

/// A socket that sends nothing.
class NoSocket final : public rtps::SenderResource {
 public:
  NoSocket() : SenderResource(LOCATOR_KIND_UDPv4) {
    send_lambda_ = [](const auto*, auto, auto* first, auto* last, const auto&) {
      for (; *first != *last; ++*first) benchmark::DoNotOptimize(&**first);
      return true;
    };
  }
};

class NoReceiver final : public fdr::TransportReceiverInterface {
 public:
  void OnDataReceived(const rtps::octet* bytes,
                      std::uint32_t /*size*/,
                      const rtps::Locator_t& /*local*/,
                      const rtps::Locator_t& /*remote*/) override {
    benchmark::DoNotOptimize(bytes);
  }
};

/// The transport of a participant that knows one other, with `addresses`, and has heard it.
class KnownPeer {
 public:
  explicit KnownPeer(int addresses) {
    const eprosima::fastrtps::ResourceLimitedContainerConfig one(1, 1, 1);
    rtps::LocatorSelector selector(one);
    rtps::LocatorSelectorEntry entry(4, 1);
    std::ranges::copy(kPeer, entry.remote_guid.guidPrefix.value);
    entry.remote_guid.entityId = 0x102;
    for (int i = 1; i <= addresses; ++i) {
      entry.unicast.push_back(locator_at(i));
      destinations_.push_back(locator_at(i));
    }
    selector.add_entry(&entry);
    selector.reset(true);
    selector.selection_start();
    transport_->select_locators(selector);
    receive();
  }
  void receive() {
    transport_->receive(&receiver_, datagram_.data(), size_of_datagram(), source_, source_);
  }
  void send() {
    rtps::Locators first(destinations_.begin());
    rtps::Locators last(destinations_.end());
    transport_->send(&socket_, sent_.data(), size_of_datagram(), &first, &last, {});
  }

 private:
  [[nodiscard]] std::uint32_t size_of_datagram() const {
    return static_cast<std::uint32_t>(datagram_.size());
  }
  static std::unique_ptr<fdr::ChainingTransport> made() {
    const auto descriptor =
        wire_transport(std::make_shared<fdr::UDPv4TransportDescriptor>(),
                       RtpsLimits{},
                       std::make_shared<WireLink>(ChannelRole::kRobot, std::nullopt));
    return std::unique_ptr<fdr::ChainingTransport>(
        dynamic_cast<fdr::ChainingTransport*>(descriptor->create_transport()));
  }

  std::unique_ptr<fdr::ChainingTransport> transport_ = made();
  NoReceiver receiver_;
  NoSocket socket_;
  fdr::LocatorList destinations_;
  const rtps::Locator_t source_ = locator_at(1);
  const Bytes datagram_ = one_datagram();
  const Bytes sent_ = message_of({Bytes(datagram_.begin() + 20, datagram_.end())}, {9});
};

KnownPeer& peer_with(int addresses) {
  static KnownPeer one(1);
  static KnownPeer three(3);
  return addresses == 1 ? one : three;
}

void receive_datagram(benchmark::State& state) {
  KnownPeer& peer = peer_with(1);
  while (state.KeepRunning()) peer.receive();
}
BENCHMARK(receive_datagram)->Threads(1)->Threads(2)->Threads(4)->UseRealTime();

void send_datagram(benchmark::State& state) {
  KnownPeer& peer = peer_with(static_cast<int>(state.range(0)));
  while (state.KeepRunning()) peer.send();
}
BENCHMARK(send_datagram)
    ->ArgName("addresses")
    ->Arg(1)
    ->Arg(3)
    ->Threads(1)
    ->Threads(2)
    ->Threads(4)
    ->UseRealTime();

// Half of the threads send, the others receive.
void send_and_receive_datagrams(benchmark::State& state) {
  KnownPeer& peer = peer_with(1);
  const bool sends = state.thread_index() % 2 == 0;
  while (state.KeepRunning()) sends ? peer.send() : peer.receive();
}
BENCHMARK(send_and_receive_datagrams)->Threads(2)->Threads(4)->UseRealTime();

struct Sample {
  const char* name;
  TopicSpec spec;
  Bytes bytes;
};

// As large as they come in the field.
std::vector<Sample> samples() {
  std::vector<Sample> samples;
  samples.push_back({"session", topic_spec(Topic::kSession, "cloud_1"), encode(some_session())});
  samples.push_back(
      {"full_submap", topic_spec(Topic::kSubmap, "cloud_1"), encode(some_submap(10, 80))});
  samples.push_back({"submap",
                     topic_spec(Topic::kCompactSubmap, "cloud_1"),
                     encode_compact(moving_robot(100, 3), {}, {}, some_stereo())});
  samples.push_back({"localization",
                     topic_spec(Topic::kLocalization, "robot_1"),
                     encode(Answer{some_answer(), some_correction()}, 1200)});
  samples.push_back(
      {"robot_status", topic_spec(Topic::kRobotStatus, "cloud_1"), encode(some_robot_status())});
  samples.push_back({"localizer_status",
                     topic_spec(Topic::kLocalizerStatus, ""),
                     encode(some_localizer_status())});
  samples.push_back({"pose", pose_topic_spec("robot_1"), encode(some_pose_estimate())});
  return samples;
}

// A writer asks for it once a sample.
void key_of_sent(benchmark::State& state, Sample& sample) {
  rtps::InstanceHandle_t handle;
  while (state.KeepRunning()) sample.spec.type->getKey(&sample.bytes, &handle, false);
  state.counters["payload_bytes"] = static_cast<double>(sample.bytes.size());
}

// A reader decodes a sample for its key, once; into an object of its own.
void key_of_received(benchmark::State& state, Sample& sample) {
  rtps::SerializedPayload_t payload(static_cast<std::uint32_t>(sample.bytes.size()));
  sample.spec.type->serialize(&sample.bytes, &payload);
  Bytes own;
  rtps::InstanceHandle_t handle;
  while (state.KeepRunning()) {
    sample.spec.type->deserialize(&payload, &own);
    sample.spec.type->getKey(&own, &handle, false);
  }
}

void route_to_known_address(benchmark::State& state) {
  static RouteCache routes;
  while (state.KeepRunning()) {
    benchmark::DoNotOptimize(routes.has_route(0x7f000001, RouteCache::Clock::now()));
  }
}
BENCHMARK(route_to_known_address)->Threads(1)->Threads(2)->Threads(4)->UseRealTime();

/// A robot and a localizer in this process, whose samples pass through the kernel.
class Ends {
 public:
  explicit Ends(std::size_t rows) : submap_(numbered_submap(1, "robot_1", rows)) {}

  bool deliver() {
    robot_.send("cloud_1", submap_, {});
    const bool arrived = cloud_.wait_for_message(std::chrono::milliseconds(200));
    static_cast<void>(cloud_.receive({}));
    return arrived;
  }
  bool matched() { return matches(robot_, Topic::kSubmap, "cloud_1") && (deliver() || deliver()); }
  [[nodiscard]] std::size_t payload_bytes() const { return submap_.payload.size(); }

 private:
  const TestNetwork network_;
  DdsChannel robot_{on_loopback(network_.domain(), ChannelRole::kRobot, "robot_1")};
  DdsChannel cloud_{on_loopback(network_.domain(), ChannelRole::kCloud, "cloud_1")};
  Message submap_;
};

// One after the other; the CPU time is that of both ends.
void submap_over_dds(benchmark::State& state) {
  Ends ends(static_cast<std::size_t>(state.range(0)) * 500);
  if (!ends.matched()) return state.SkipWithError("the ends have not matched");
  std::int64_t lost = 0;
  while (state.KeepRunning()) lost += ends.deliver() ? 0 : 1;
  state.SetItemsProcessed(state.iterations() - lost);
  state.counters["payload_bytes"] = static_cast<double>(ends.payload_bytes());
  state.counters["lost"] = static_cast<double>(lost);
}
BENCHMARK(submap_over_dds)
    ->ArgName("kB")
    ->Arg(1)
    ->Arg(10)
    ->Arg(60)
    ->Unit(benchmark::kMicrosecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

}  // namespace
}  // namespace fleetloc

int main(int argc, char** argv) {
  auto samples = fleetloc::samples();
  for (fleetloc::Sample& sample : samples) {
    const std::string name = sample.name;
    benchmark::RegisterBenchmark(("key_of_sent/" + name).c_str(),
                                 [&](auto& state) { key_of_sent(state, sample); });
    benchmark::RegisterBenchmark(("key_of_received/" + name).c_str(),
                                 [&](auto& state) { key_of_received(state, sample); });
  }
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
