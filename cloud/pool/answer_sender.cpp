#include "cloud/pool/answer_sender.hpp"

#include <utility>

#include "shared/wire/correction_codec.hpp"
#include "shared/wire/localization_result_codec.hpp"

namespace fleetloc {
namespace {

// A solution beyond all bounds harms only its own robot.
template <typename T>
expected<Message, PoolRefusal> encoded(Topic topic, const T& value, PoolRefusal refusal) {
  try {
    return Message{topic, encode(value)};
  } catch (const NotEncodable&) {
    return unexpected(refusal);
  }
}

}  // namespace

void AnswerSender::set(LocalizationResult answer, std::optional<Correction> correction) {
  answer_ = std::move(answer);
  correction_ = std::move(correction);
  is_unsent_ = true;
}

void AnswerSender::reset() {
  answer_.reset();
  correction_.reset();
  is_unsent_ = false;
}

std::vector<expected<Message, PoolRefusal>> AnswerSender::due(const SubmapReceiver& received,
                                                              Timestamp now) {
  if (!answer_) return {};
  if (!is_unsent_ && !retransmission_.due(now, received.loss())) return {};
  if (is_unsent_) retransmission_.sent(now);
  is_unsent_ = false;
  answer_->acknowledgements = received.acknowledgements();
  std::vector<expected<Message, PoolRefusal>> messages;
  messages.push_back(encoded(Topic::kLocalization, *answer_, PoolRefusal::kNotEncodable));
  if (!messages.back()) answer_.reset();
  if (correction_) {
    messages.push_back(
        encoded(Topic::kCorrection, *correction_, PoolRefusal::kCorrectionNotEncodable));
    correction_.reset();
  }
  return messages;
}

}  // namespace fleetloc
