#include "shared/transport/workarounds/initial_ack_pacing.hpp"

#include <algorithm>
#include <initializer_list>
#include <optional>

namespace fleetloc {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr milliseconds kFirstAckPause{200};
constexpr seconds kLongestPause{13};  // 0.2 s, doubled six times
// The library has stopped asking, and when it begins again, that is another match.
constexpr seconds kOver{2};
// Encrypted, it may as well be the answer to a heartbeat, of which there are fewer than three a
// second.
constexpr milliseconds kOverIfEncrypted{300};

constexpr std::size_t kPrefixBytes = 12;
constexpr std::size_t kDestinationBytes = 4 + kPrefixBytes;
constexpr std::size_t kAckNackBytes = 4 + kEntitiesBytes + 8 + 4 + 4;  // without a set
constexpr std::size_t kDatagramBytes = kRtpsHeaderBytes + kDestinationBytes + kAckNackBytes;
constexpr std::size_t kLengthBytes = 4;  // before what is encrypted

using Question = std::array<std::uint8_t, kPrefixBytes + kEntitiesBytes>;

Question joined(std::initializer_list<RtpsBytes> parts) {
  Question question{};
  auto end = question.begin();
  for (const RtpsBytes part : parts) end = std::ranges::copy(part, end).out;
  return question;
}

/// Participant, reader and writer of an acknowledgement of 0.
std::optional<Question> plain(const RtpsSubmessage& acknowledgement, RtpsBytes participant) {
  if (acknowledgement.kind != RtpsKind::kAckNack) return std::nullopt;
  RtpsFields fields = acknowledgement.fields();
  const RtpsBytes entities = fields.skip(kEntitiesBytes);
  const bool is_of_nothing = fields.sequence_number() == 0;
  if (!is_of_nothing || fields.u32() != 0 || !fields.is_complete()) return std::nullopt;
  return joined({participant, entities});
}

/// Participant and key of something as long as an acknowledgement without a set; nothing else that
/// Fast DDS sends is. Each reader has a key of its own (DDS Security 1.1, chapter 9.5.2.3).
std::optional<Question> encrypted(const RtpsSubmessage& prefix,
                                  RtpsBytes rest,
                                  RtpsBytes participant) {
  constexpr std::size_t kKeyAt = 4;
  if (prefix.kind != RtpsKind::kSecPrefix || prefix.body.size() < kKeyAt + 4) return std::nullopt;
  const auto body = take_submessage(rest);
  if (!body || body->kind != RtpsKind::kSecBody) return std::nullopt;
  if (body->body.size() != kLengthBytes + kAckNackBytes) return std::nullopt;
  const auto postfix = take_submessage(rest);
  if (!postfix || postfix->kind != RtpsKind::kSecPostfix || !rest.empty()) return std::nullopt;
  return joined({participant, prefix.body.subspan(kKeyAt, 4)});
}

/// What a datagram asks that is nothing but an acknowledgement of 0, or may be.
std::optional<Question> question_in(RtpsBytes datagram, bool& is_encrypted) {
  if (datagram.size() < kDatagramBytes) return std::nullopt;
  RtpsBytes rest = datagram.subspan(kRtpsHeaderBytes);
  const auto destination = take_submessage(rest);
  if (!destination || destination->kind != RtpsKind::kInfoDestination ||
      destination->body.size() != kPrefixBytes) {
    return std::nullopt;
  }
  const auto first = take_submessage(rest);
  if (!first) return std::nullopt;
  is_encrypted = !rest.empty();
  return is_encrypted ? encrypted(*first, rest, destination->body)
                      : plain(*first, destination->body);
}

}  // namespace

bool InitialAckPacing::passes(RtpsBytes datagram, Time now) {
  bool is_encrypted = false;
  const auto key = question_in(datagram, is_encrypted);
  if (!key) return true;
  const std::lock_guard lock(mutex_);
  const auto known = questions_.find(*key);
  const Time::duration over = is_encrypted ? Time::duration(kOverIfEncrypted) : kOver;
  if (known == questions_.end() || now - known->second.asked_at > over) {
    std::erase_if(questions_, [&](const auto& one) { return now - one.second.asked_at > kOver; });
    questions_[*key] = {.asked_at = now, .due_at = now + kFirstAckPause, .pause = kFirstAckPause};
    return true;
  }
  Asked& question = known->second;
  question.asked_at = now;
  if (now < question.due_at) return false;
  question.pause = std::min<std::chrono::steady_clock::duration>(2 * question.pause, kLongestPause);
  question.due_at = now + question.pause;
  return true;
}

}  // namespace fleetloc
