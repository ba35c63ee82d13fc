#include "cloud/pool/answer_sender.hpp"

#include <algorithm>
#include <utility>

#include "shared/config/config_reader.hpp"
#include "shared/link/datagrams.hpp"
#include "shared/wire/malformed.hpp"

namespace fleetloc {
namespace {

constexpr std::size_t kMaxInFlight = 512;  // receipts of older answers give no round trip

}  // namespace

void AnswerSender::set(Answer answer) {
  answer_ = std::move(answer);
  first_sent_.reset();
}

void AnswerSender::reset() {
  answer_.reset();
  first_sent_.reset();
}

void AnswerSender::note(const AnswerReceipt& receipt, Timestamp now) {
  receipt_.loss = receipt.loss;
  if (receipt.newest > number_) return;
  receipt_.newest = std::max(receipt_.newest, receipt.newest);
  const auto sent = sent_.find(receipt.newest);
  if (sent == sent_.end() || !receipt.age) return;
  budget_.measured(std::max(Duration{}, now - sent->second - *receipt.age), now);
  sent_.erase(sent_.begin(), sent);
}

std::optional<expected<Message, PoolRefusal>> AnswerSender::due(const SubmapReceiver& received,
                                                                Timestamp now) {
  budget_.advance(now, receipt_.loss);
  if (!answer_ || !is_to_be_sent(now)) return std::nullopt;
  auto message = encoded(received, now);
  if (!message) {
    reset();
    return message;
  }
  std::size_t wire_bytes = 0;
  for (const std::size_t bytes : datagram_sizes(message->payload.size())) wire_bytes += bytes;
  budget_.spend(wire_bytes);
  return message;
}

// The budget may be overdrawn by one answer; the next one waits for it.
bool AnswerSender::is_to_be_sent(Timestamp now) {
  if (!budget_.allows(0)) return false;
  if (!first_sent_) {
    retransmission_.sent(now);
    return true;
  }
  if (to_seconds(now - *first_sent_) > config_.repeated_for_s) return false;
  const auto reserve = static_cast<std::size_t>(config_.budget.burst_bytes / 2.0);
  if (receipt_.newest >= first_number_ || !budget_.allows(reserve)) return false;
  return retransmission_.due(now, receipt_.loss);
}

// A solution beyond all bounds harms only its own robot.
expected<Message, PoolRefusal> AnswerSender::encoded(const SubmapReceiver& received,
                                                     Timestamp now) {
  Answer answer = *answer_;
  answer.result.number = ++number_;
  sent_[number_] = now;
  if (sent_.size() > kMaxInFlight) sent_.erase(sent_.begin());
  answer.result.acknowledgements = received.acknowledgements();
  answer.result.holding_time = received.since_newest(now);
  if (first_sent_) {
    answer.correction.reset();
  } else {
    first_sent_ = now;
    first_number_ = number_;
  }
  try {
    return Message{Topic::kLocalization, encode(answer, config_.max_payload_bytes)};
  } catch (const NotEncodable&) {
    return unexpected(PoolRefusal::kNotEncodable);
  }
}

AnswerSender::Config read_answer_sender_config(ConfigReader config) {
  return {.retransmission = read_retransmission_timer_config(config.section("retransmission")),
          .repeated_for_s = config.positive("repeated_for_s"),
          .max_payload_bytes =
              static_cast<std::size_t>(config.integer("max_payload_bytes", 300, 60'000)),
          .budget = read_byte_budget_config(config.section("budget"))};
}

}  // namespace fleetloc
