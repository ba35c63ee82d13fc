#pragma once

#include <utility>
#include <vector>

#include "shared/model/map_localizer.hpp"

namespace fleetloc {

/// A localizer in front of another one, to which it passes everything on.
class LocalizerDecorator : public MapLocalizer {
 public:
  /// @param inner  must outlive it
  explicit LocalizerDecorator(MapLocalizer& inner) : inner_(inner) {}

  void update(Timestamp now, Quality quality) override { inner_.update(now, quality); }
  void start_session(const RobotSession& session, Timestamp now) override {
    inner_.start_session(session, now);
  }
  void restart_session(const RobotSession& session, Timestamp now) override {
    inner_.restart_session(session, now);
  }
  void submit(Submap submap, Timestamp now) override { inner_.submit(std::move(submap), now); }
  [[nodiscard]] std::vector<LocalizationResult> take_answers(Timestamp now) override {
    return inner_.take_answers(now);
  }
  [[nodiscard]] std::optional<Correction> take_correction() override {
    return inner_.take_correction();
  }
  void note_applied() override { inner_.note_applied(); }
  void update_start(const MapOdomEstimate& start) override { inner_.update_start(start); }
  [[nodiscard]] LinkTraffic traffic() const override { return inner_.traffic(); }

 private:
  MapLocalizer& inner_;
};

}  // namespace fleetloc
