#include "cloud/pool/answer_sender.hpp"

#include <utility>

#include "shared/config/config_reader.hpp"
#include "shared/link/datagrams.hpp"
#include "shared/wire/malformed.hpp"

namespace fleetloc {

void AnswerSender::set(Answer answer) {
  answer_ = std::move(answer);
  first_sent_.reset();
}

void AnswerSender::reset() {
  answer_.reset();
  first_sent_.reset();
}

std::optional<expected<Message, PoolRefusal>> AnswerSender::due(const SubmapReceiver& received,
                                                                Timestamp now) {
  const bool is_bad = receipt_.loss >= config_.high_loss;
  tokens_.advance(now, is_bad ? config_.max_bytes_per_s_high_loss : config_.max_bytes_per_s);
  if (!answer_ || !is_to_be_sent(now)) return std::nullopt;
  auto message = encoded(received, now);
  if (!message) {
    reset();
    return message;
  }
  std::size_t wire_bytes = 0;
  for (const std::size_t bytes : datagram_sizes(message->payload.size())) wire_bytes += bytes;
  tokens_.spend(wire_bytes);
  return message;
}

// The budget may be overdrawn by one answer; the next one waits for it.
bool AnswerSender::is_to_be_sent(Timestamp now) {
  if (!tokens_.allows(0)) return false;
  if (!first_sent_) {
    retransmission_.sent(now);
    return true;
  }
  const auto reserve = static_cast<std::size_t>(config_.burst_bytes / 2.0);
  if (receipt_.newest >= first_number_ || !tokens_.allows(reserve)) return false;
  return retransmission_.due(now, receipt_.loss);
}

// A solution beyond all bounds harms only its own robot.
expected<Message, PoolRefusal> AnswerSender::encoded(const SubmapReceiver& received,
                                                     Timestamp now) {
  Answer answer = *answer_;
  answer.result.number = ++number_;
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
          .max_payload_bytes =
              static_cast<std::size_t>(config.integer("max_payload_bytes", 300, 60'000)),
          .max_bytes_per_s = config.positive("max_bytes_per_s"),
          .max_bytes_per_s_high_loss = config.positive("max_bytes_per_s_high_loss"),
          .high_loss = config.positive("high_loss"),
          .burst_bytes = config.positive("burst_bytes")};
}

}  // namespace fleetloc
