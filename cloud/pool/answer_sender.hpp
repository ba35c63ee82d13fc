#pragma once

#include <optional>
#include <vector>

#include "cloud/pool/pool_refusal.hpp"
#include "shared/core/expected.hpp"
#include "shared/link/channel.hpp"
#include "shared/model/correction.hpp"
#include "shared/model/localization_result.hpp"
#include "shared/protocol/retransmission_timer.hpp"
#include "shared/protocol/submap_receiver.hpp"

namespace fleetloc {

/// The latest answer to one robot: sent with its correction, then repeated until there is a newer
/// one. The correction is sent once: a lost one is made up for by the next.
class AnswerSender {
 public:
  explicit AnswerSender(const RetransmissionTimer::Config& config) : retransmission_(config) {}

  void set(LocalizationResult answer, std::optional<Correction> correction);
  void reset();

  /// Whether the latest answer has a pose.
  [[nodiscard]] bool is_localized() const {
    return answer_ && answer_->status == LocalizationStatus::kLocalized;
  }

  /// What is to be sent now, if anything; an answer that cannot be encoded is dropped.
  /// @param received  of the robot's submaps: gives the acknowledgements, and its loss the rate
  std::vector<expected<Message, PoolRefusal>> due(const SubmapReceiver& received, Timestamp now);

 private:
  std::optional<LocalizationResult> answer_;
  bool is_unsent_ = false;
  std::optional<Correction> correction_;  // of that answer, until it is sent
  RetransmissionTimer retransmission_;
};

}  // namespace fleetloc
