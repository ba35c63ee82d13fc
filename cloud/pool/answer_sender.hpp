#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "cloud/pool/pool_refusal.hpp"
#include "shared/compact/answer_sample.hpp"
#include "shared/compact/submap_sample.hpp"
#include "shared/core/expected.hpp"
#include "shared/link/channel.hpp"
#include "shared/protocol/retransmission_timer.hpp"
#include "shared/protocol/submap_receiver.hpp"
#include "shared/protocol/token_bucket.hpp"

namespace fleetloc {

class ConfigReader;

/// The latest answer to one robot: sent at once with its corrections, then repeated alone until the
/// robot tells that it has arrived or there is a newer one, the more often, the more answers get
/// lost; all within a budget of bytes, half of which is kept for new answers.
class AnswerSender {
 public:
  struct Config {
    RetransmissionTimer::Config retransmission;
    std::size_t max_payload_bytes;
    double max_bytes_per_s;            ///< on the wire
    double max_bytes_per_s_high_loss;  ///< the same, from `high_loss` on
    double high_loss;                  ///< share of answers
    double burst_bytes;
  };

  explicit AnswerSender(const Config& config)
      : config_(config), retransmission_(config.retransmission), tokens_(config.burst_bytes) {}

  void set(Answer answer);
  void reset();

  /// What the robot tells of the answers that it has got.
  void note(const AnswerReceipt& receipt) { receipt_ = receipt; }

  /// Whether the latest answer has a pose.
  [[nodiscard]] bool is_localized() const {
    return answer_ && answer_->result.status == LocalizationStatus::kLocalized;
  }

  /// What is to be sent now, if anything; an answer that cannot be encoded is dropped.
  /// @param received  of the robot's submaps: gives the acknowledgements
  std::optional<expected<Message, PoolRefusal>> due(const SubmapReceiver& received, Timestamp now);

 private:
  [[nodiscard]] bool is_to_be_sent(Timestamp now);
  expected<Message, PoolRefusal> encoded(const SubmapReceiver& received, Timestamp now);

  Config config_;
  std::optional<Answer> answer_;
  std::optional<Timestamp> first_sent_;  // of that answer
  std::uint32_t first_number_ = 0;       // the same
  std::uint32_t number_ = 0;             // of the last sample
  AnswerReceipt receipt_;
  RetransmissionTimer retransmission_;
  TokenBucket tokens_;
};

AnswerSender::Config read_answer_sender_config(ConfigReader config);

}  // namespace fleetloc
