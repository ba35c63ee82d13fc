#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "robot/uplink/delivery_record.hpp"
#include "robot/uplink/keyframe_history.hpp"
#include "shared/compact/submap_sample.hpp"
#include "shared/link/channel.hpp"
#include "shared/model/camera.hpp"
#include "shared/model/localization_result.hpp"
#include "shared/model/session.hpp"
#include "shared/protocol/byte_budget.hpp"
#include "shared/protocol/submap_sender.hpp"

namespace fleetloc {

class ConfigReader;

/// Which keyframes are sent when. In the compact encoding each sample is one datagram, within a
/// byte budget. The newest keyframe goes out as soon as the budget allows, with those before it
/// that the cloud probably lacks. What is left of the budget brings older keyframes that were lost,
/// while they can still help: the cloud's window ends at the oldest one here. Nothing in a sample
/// refers to another one; acknowledgements only tell what need not be repeated.
///
/// In the full encoding (the paper's) each window is sent as it is, once.
class SubmapUplink {
 public:
  struct Config {
    SubmapEncoding encoding;
    std::size_t keyframes;            ///< remembered: the cloud's window
    std::size_t window;               ///< of them may be in one sample
    double min_missing;               ///< share below which an item is not repeated
    double min_missing_alone;         ///< the same, for a datagram without the newest keyframe
    double min_missing_edge;          ///< the same, for edges: small, and nothing helps without
    double risky_loss;                ///< from which on edges over many keyframes are added
    std::uint32_t step_bits;          ///< pixels are rounded to 2^-step_bits px
    std::uint32_t thinned_step_bits;  ///< where only every second observation is sent
    std::size_t max_payload_bytes;
    double min_pause_s;              ///< between datagrams
    std::size_t handover_datagrams;  ///< beyond the budget, for a localizer that takes over
    double handover_pause_s;         ///< between these
    ByteBudget::Config budget;
  };

  SubmapUplink(RobotId robot, const Config& config);

  /// A new session of the odometry: the keyframes before it are of no use.
  void start_session(const RectifiedStereo& stereo);

  /// A new stream of samples, to an incarnation of a localizer that has nothing of this session.
  /// @param used  see SubmapSender::restart
  void restart(SessionNumber session, Incarnation incarnation, std::uint32_t used = 0);

  /// The localizer has lost what it had of this session; the stream goes on.
  void forget_deliveries();

  /// The odometry's newest window.
  void add(Submap window);

  /// The next sample, if one is to be sent now. Counts it as sent.
  /// @throws NotEncodable for a keyframe beyond the range of the wire; all known ones are forgotten
  std::optional<Message> next(const AnswerReceipt& receipt, Timestamp now);

  void acknowledge(const LocalizationResult& answer, Timestamp now);

  [[nodiscard]] SubmapEncoding encoding() const { return config_.encoding; }
  [[nodiscard]] const SubmapSender& sender() const { return sender_; }
  [[nodiscard]] const ByteBudget& budget() const { return budget_; }

 private:
  struct Plan {
    Submap submap;
    CompactPrecision precision;
    std::size_t wire_bytes = 0;
  };

  void grant_handover();
  [[nodiscard]] bool has_lost_touch(Timestamp now) const;
  std::optional<Message> next_window(Timestamp now);
  std::optional<Message> next_sample(const AnswerReceipt& receipt, Timestamp now);
  std::optional<Plan> plan_newest() const;
  std::optional<Plan> plan_missing() const;
  /// Those of `keyframes` that fit one datagram, the newest but with that at `needed`, with the
  /// edges that the cloud lacks.
  [[nodiscard]] std::optional<Plan> fitted(const std::vector<KeyframeId>& keyframes,
                                           std::size_t needed,
                                           bool with_newest) const;
  [[nodiscard]] Plan plan(std::span<const KeyframeId> keyframes,
                          bool with_newest,
                          const CompactPrecision& precision,
                          std::size_t& payload_bytes) const;
  [[nodiscard]] double keyframe_interval_s() const;
  [[nodiscard]] std::vector<EdgeKey> edges_for(std::span<const KeyframeId> keyframes,
                                               bool with_newest) const;
  [[nodiscard]] std::optional<KeyframeId> most_missing() const;
  Bytes encoded(Plan& plan, const AnswerReceipt& receipt, Timestamp now);

  RobotId robot_;
  Config config_;
  SubmapSender sender_;
  KeyframeHistory history_;
  DeliveryRecord record_;
  ByteBudget budget_;
  double loss_ = 0.0;                      // of the link, as far as it is known
  std::optional<Timestamp> acknowledged_;  // when the last answer came, of any stream
  RectifiedStereo stereo_;
  std::optional<Submap> window_;  // not sent yet, in the full encoding
  bool has_unsent_ = false;       // the newest keyframe
  std::optional<Plan> planned_;   // for it
  std::optional<Timestamp> sent_;
  std::size_t last_bytes_ = 0;  // of the last sample with a newest keyframe
};

SubmapUplink::Config read_submap_uplink_config(ConfigReader config);

}  // namespace fleetloc
