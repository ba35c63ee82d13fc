#include "shared/transport/workarounds/initial_ack_pacing.hpp"

#include <algorithm>
#include <optional>

namespace fleetloc {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr milliseconds kFirstAckPause{200};
constexpr seconds kLongestPause{13};  // 0.2 s, doubled six times
// The library has stopped asking, and when it begins again, that is another match.
constexpr seconds kOver{2};

constexpr std::size_t kPrefixBytes = 12;
constexpr std::size_t kDestinationBytes = 4 + kPrefixBytes;
constexpr std::size_t kAckNackBytes = 4 + kEntitiesBytes + 8 + 4 + 4;  // without a set
constexpr std::size_t kDatagramBytes = kRtpsHeaderBytes + kDestinationBytes + kAckNackBytes;

/// Participant, reader and writer of a datagram that is nothing but an acknowledgement of 0.
std::optional<std::array<std::uint8_t, kPrefixBytes + kEntitiesBytes>> question_in(
    RtpsBytes datagram) {
  if (datagram.size() != kDatagramBytes) return std::nullopt;
  RtpsBytes rest = datagram.subspan(kRtpsHeaderBytes);
  const auto destination = take_submessage(rest);
  if (!destination || destination->kind != RtpsKind::kInfoDestination ||
      destination->body.size() != kPrefixBytes) {
    return std::nullopt;
  }
  const auto acknowledgement = take_submessage(rest);
  if (!acknowledgement || acknowledgement->kind != RtpsKind::kAckNack) return std::nullopt;
  RtpsFields fields = acknowledgement->fields();
  const RtpsBytes entities = fields.skip(kEntitiesBytes);
  const bool is_of_nothing = fields.sequence_number() == 0;
  if (!is_of_nothing || fields.u32() != 0 || !fields.is_complete()) return std::nullopt;
  std::array<std::uint8_t, kPrefixBytes + kEntitiesBytes> question{};
  std::ranges::copy(destination->body, question.begin());
  std::ranges::copy(entities, question.begin() + kPrefixBytes);
  return question;
}

}  // namespace

bool InitialAckPacing::passes(RtpsBytes datagram, Time now) {
  const auto key = question_in(datagram);
  if (!key) return true;
  const std::lock_guard lock(mutex_);
  const auto known = questions_.find(*key);
  if (known == questions_.end() || now - known->second.asked_at > kOver) {
    std::erase_if(questions_, [&](const auto& one) { return now - one.second.asked_at > kOver; });
    questions_[*key] = {.asked_at = now, .due_at = now + kFirstAckPause, .pause = kFirstAckPause};
    return true;
  }
  Question& question = known->second;
  question.asked_at = now;
  if (now < question.due_at) return false;
  question.pause = std::min<std::chrono::steady_clock::duration>(2 * question.pause, kLongestPause);
  question.due_at = now + question.pause;
  return true;
}

}  // namespace fleetloc
