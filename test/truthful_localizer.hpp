#pragma once

#include <functional>
#include <utility>
#include <vector>

#include "shared/model/map_localizer.hpp"

namespace fleetloc {

/// A correction that a robot can only count: of a landmark that it has never seen.
inline Correction of_unknown_landmark(KeyframeId anchor) {
  Correction correction;
  correction.anchor = anchor;
  correction.landmarks.push_back({.id = LandmarkId{4'000'000'000}});
  return correction;
}

/// Answers each submap at once, 2 cm and 0.2 degrees (one sigma) uncertain but without error.
class TruthfulLocalizer final : public MapLocalizer {
 public:
  /// @param T_map_body  at a stamp
  explicit TruthfulLocalizer(std::function<Pose(Timestamp)> T_map_body)
      : T_map_body_(std::move(T_map_body)) {}

  void update(Timestamp /*now*/, Quality /*quality*/) override {}
  void start_session(const RobotSession& session, Timestamp /*now*/) override {
    sessions.push_back(session);
    submaps_of_session.push_back(0);
    first_keyframes.emplace_back();
  }
  void submit(Submap submap, Timestamp /*now*/) override {
    const auto& newest = submap.keyframes.back();
    if (submaps_of_session.back()++ == 0) first_keyframes.back() = submap.keyframes.front().id;
    if (!answering) return;
    LocalizationResult answer;
    answer.robot = sessions.back().robot;
    answer.session = sessions.back().session;
    answer.localizer = "truthful";
    answer.keyframe = newest.id;
    answer.status = status;
    answer.stamp = newest.stamp;
    answer.oldest_stamp = submap.keyframes.front().stamp;
    answer.T_map_body = T_map_body_(newest.stamp);
    answer.covariance.diagonal() << 1e-5, 1e-5, 1e-5, 4e-4, 4e-4, 4e-4;
    answers_.push_back(answer);
    if (correcting) correction = of_unknown_landmark(newest.id);
  }
  [[nodiscard]] std::vector<LocalizationResult> take_answers(Timestamp /*now*/) override {
    return std::exchange(answers_, {});
  }
  [[nodiscard]] std::optional<Correction> take_correction() override {
    return std::exchange(correction, std::nullopt);
  }
  void note_applied() override { ++applied; }
  void update_start(const MapOdomEstimate& start) override { updated_start = start; }
  [[nodiscard]] LinkTraffic traffic() const override { return {}; }

  bool answering = true;
  LocalizationStatus status = LocalizationStatus::kLocalized;
  bool correcting = false;               // with each answer
  std::optional<Correction> correction;  // the next one
  std::vector<RobotSession> sessions;
  std::vector<int> submaps_of_session;
  std::vector<KeyframeId> first_keyframes;
  std::optional<MapOdomEstimate> updated_start;
  int applied = 0;

 private:
  std::function<Pose(Timestamp)> T_map_body_;
  std::vector<LocalizationResult> answers_;
};

}  // namespace fleetloc
