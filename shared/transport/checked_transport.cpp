#include "shared/transport/checked_transport.hpp"

#include <utility>

#include <fastdds/rtps/network/SenderResource.h>
#include <fastdds/rtps/transport/ChainingTransport.h>
#include <fastdds/rtps/transport/ChainingTransportDescriptor.h>
#include <fastdds/rtps/transport/UDPTransportDescriptor.h>

#include "shared/transport/workarounds/gap_budget.hpp"

namespace fleetloc {

namespace fdr = eprosima::fastdds::rtps;
namespace rtps = eprosima::fastrtps::rtps;

namespace {

struct CheckedDescriptor final : public fdr::ChainingTransportDescriptor {
  CheckedDescriptor(std::shared_ptr<TransportDescriptor> udp,
                    const RtpsLimits& its_limits,
                    std::shared_ptr<MalformedDatagrams> its_refused)
      : ChainingTransportDescriptor(std::move(udp)),
        limits(its_limits),
        refused(std::move(its_refused)) {}

  [[nodiscard]] fdr::TransportInterface* create_transport() const override;

  RtpsLimits limits;
  std::shared_ptr<MalformedDatagrams> refused;
};

class CheckedTransport final : public fdr::ChainingTransport {
 public:
  explicit CheckedTransport(const CheckedDescriptor& descriptor)
      : ChainingTransport(descriptor), descriptor_(descriptor) {}

  fdr::TransportDescriptorInterface* get_configuration() override { return &descriptor_; }

  bool send(rtps::SenderResource* socket,
            const rtps::octet* buffer,
            std::uint32_t size,
            rtps::LocatorsIterator* begin,
            rtps::LocatorsIterator* end,
            const std::chrono::steady_clock::time_point& timeout) override {
    return socket->send(buffer, size, begin, end, timeout);
  }

  void receive(fdr::TransportReceiverInterface* receiver,
               const rtps::octet* buffer,
               std::uint32_t size,
               const rtps::Locator_t& local,
               const rtps::Locator_t& remote) override {
    const auto checked = check_rtps({buffer, size}, descriptor_.limits);
    if (!checked) return descriptor_.refused->add(checked.error());
    if (!gaps_.passes({buffer, size}, GapBudget::Clock::now())) {
      return descriptor_.refused->add(RtpsDefect::kTooManyGaps);
    }
    receiver->OnDataReceived(buffer, size, local, remote);
  }

 private:
  CheckedDescriptor descriptor_;
  GapBudget gaps_;
};

fdr::TransportInterface* CheckedDescriptor::create_transport() const {
  return new CheckedTransport(*this);
}

}  // namespace

std::shared_ptr<TransportDescriptor> checked_transport(
    const std::shared_ptr<TransportDescriptor>& udp,
    const RtpsLimits& limits,
    std::shared_ptr<MalformedDatagrams> refused) {
  if (!std::dynamic_pointer_cast<fdr::UDPTransportDescriptor>(udp)) return nullptr;
  return std::make_shared<CheckedDescriptor>(udp, limits, std::move(refused));
}

}  // namespace fleetloc
