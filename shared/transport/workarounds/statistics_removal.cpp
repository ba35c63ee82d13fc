#include "shared/transport/workarounds/statistics_removal.hpp"

namespace fleetloc {
namespace {

constexpr std::size_t kWholeStatisticsBytes = 60;  // with the head of the submessage

bool has_mark(RtpsBytes datagram) {
  return datagram.size() >= kRtpsHeaderBytes + kWholeStatisticsBytes &&
         datagram[datagram.size() - kWholeStatisticsBytes] ==
             static_cast<std::uint8_t>(RtpsKind::kStatistics);
}

}  // namespace

RtpsBytes without_statistics(RtpsBytes datagram) {
  if (!has_mark(datagram)) return datagram;
  RtpsBytes rest = datagram.subspan(kRtpsHeaderBytes);
  while (rest.size() > kWholeStatisticsBytes && take_submessage(rest)) continue;
  if (rest.size() != kWholeStatisticsBytes) return datagram;  // it is part of something else
  const RtpsBytes shorter = datagram.first(datagram.size() - kWholeStatisticsBytes);
  return has_mark(shorter) ? datagram : shorter;
}

}  // namespace fleetloc
