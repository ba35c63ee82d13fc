#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>

#include "cloud/pool/pool_refusal.hpp"
#include "shared/compact/answer_sample.hpp"
#include "shared/compact/submap_sample.hpp"
#include "shared/core/expected.hpp"
#include "shared/link/channel.hpp"
#include "shared/protocol/byte_budget.hpp"
#include "shared/protocol/retransmission_timer.hpp"
#include "shared/protocol/submap_receiver.hpp"

namespace fleetloc {

class ConfigReader;

/// The latest answer to one robot: sent at once with its corrections, then repeated alone until the
/// robot tells that it has arrived, there is a newer one, or it is too old to help; the more often,
/// the more answers get lost. All within a budget of bytes, which follows the queueing delay of the
/// downlink, and of which half a burst is kept for new answers.
class AnswerSender {
 public:
  struct Config {
    RetransmissionTimer::Config retransmission;
    double repeated_for_s;
    std::size_t max_payload_bytes;
    ByteBudget::Config budget;
  };

  /// @param number  of the last sample that the robot may have got from this localizer
  explicit AnswerSender(const Config& config, std::uint32_t number = 0)
      : config_(config),
        number_(number),
        retransmission_(config.retransmission),
        budget_(config.budget) {}

  /// Of the last sample.
  [[nodiscard]] std::uint32_t number() const { return number_; }

  void set(Answer answer);
  void reset();

  /// What the robot tells of the answers that it has got. It may be late, and it may be of answers
  /// that somebody else has sent in this localizer's name.
  void note(const AnswerReceipt& receipt, Timestamp now);

  [[nodiscard]] const ByteBudget& budget() const { return budget_; }

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
  std::map<std::uint32_t, Timestamp> sent_;  // the latest samples, by number
  ByteBudget budget_;
};

AnswerSender::Config read_answer_sender_config(ConfigReader config);

}  // namespace fleetloc
