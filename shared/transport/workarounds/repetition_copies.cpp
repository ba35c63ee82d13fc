#include "shared/transport/workarounds/repetition_copies.hpp"

#include <algorithm>
#include <cmath>

namespace fleetloc {
namespace {

constexpr std::chrono::seconds kPatience{20};
constexpr std::chrono::seconds kSaidForgotten{4};  // four of the library's periods
constexpr std::chrono::minutes kDestinationForgotten{5};
// Within the library's shortest period it repeats itself since somebody else has asked.
constexpr std::chrono::milliseconds kForSomebodyElse{250};
// So long an answer may take on a line that is narrow and slow; copies would only fill it. What is
// repeated for longer is lost, and then so is what is repeated next.
constexpr std::chrono::milliseconds kDiscoveryDelay{2500};
constexpr std::chrono::milliseconds kSampleDelay{5000};  // beside submaps
constexpr std::size_t kManyRemembered = 2000;  // then those are dropped that are forgotten
constexpr double kMoreForARepetition = 1.5;
constexpr double kFewerForANewStatement = 0.6;
constexpr double kSavedBytes = 200e3;  // a match where 90 % are lost takes so many
constexpr double kBytesPerSecond = 500.0;

template <typename Remembered>
void forget(Remembered& remembered, std::chrono::seconds after, RepetitionCopies::Time now) {
  if (remembered.size() <= kManyRemembered) return;
  std::erase_if(remembered, [&](const auto& one) { return now - one.second.last > after; });
}

}  // namespace

// With its budget as it is now; as new if it has not been used for long.
RepetitionCopies::Destination& RepetitionCopies::destination(const Locator& to, Time now) {
  forget(destinations_, kDestinationForgotten, now);
  const auto [item, is_new] = destinations_.try_emplace(to);
  Destination& known = item->second;
  const std::chrono::duration<double> unused = now - known.last;
  if (is_new || unused > kDestinationForgotten) {
    known = {.bytes_left = kSavedBytes};
  } else {
    known.bytes_left = std::min(kSavedBytes, known.bytes_left + unused.count() * kBytesPerSecond);
  }
  known.last = now;
  return known;
}

int RepetitionCopies::copies(const RepeatedDatagram& datagram,
                             const Locator& to,
                             std::size_t bytes,
                             Time now) {
  if (max_copies_ <= 1) return 1;
  const std::lock_guard lock(mutex_);
  forget(said_, kSaidForgotten, now);
  Said& said = said_[datagram.statement];
  if (now - said.last > kSaidForgotten) said = {.first = now};
  if (said.times > 0 && now - said.last < kForSomebodyElse) return 1;
  said.last = now;
  ++said.times;
  if (now - said.first > kPatience) return 1;

  Destination& known = destination(to, now);
  if (said.times == 1) {
    known.copies *= kFewerForANewStatement;
  } else if (known.copies > 1.0 ||
             now - said.first > (datagram.is_discovery ? kDiscoveryDelay : kSampleDelay)) {
    known.copies *= kMoreForARepetition;
  }
  known.copies = std::clamp(known.copies, 1.0, static_cast<double>(max_copies_));
  const double affordable = 1.0 + known.bytes_left / static_cast<double>(bytes);
  const int copies = static_cast<int>(std::min(std::round(known.copies), affordable));
  known.bytes_left -= (copies - 1) * static_cast<double>(bytes);
  return copies;
}

}  // namespace fleetloc
