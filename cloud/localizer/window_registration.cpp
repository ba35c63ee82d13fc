#include "cloud/localizer/window_registration.hpp"

#include <algorithm>
#include <span>
#include <utility>

namespace fleetloc {
namespace {

constexpr std::size_t kBytesPerObservation = 700;  // residual block, factor and their places

// [rad, m], as one number.
double distance(const Pose& from, const Pose& to) {
  return local_coordinates(from, to).norm();
}

WindowRegistration::Convergence read_convergence(ConfigReader section) {
  return {.max_rounds = section.integer("max_rounds", 1, 100),
          .iterations = section.integer("iterations", 1, 100),
          .min_decrease = section.positive("min_decrease"),
          .settled_m = section.positive("settled_m")};
}

WindowRegistration::Rounds read_rounds(ConfigReader section) {
  return {.final_gate_m = section.positive("final_gate_m"),
          .tracking_gate_m = section.positive("tracking_gate_m"),
          .widest_gate_m = section.positive("widest_gate_m"),
          .gate_sigmas = section.positive("gate_sigmas"),
          .shrink = section.positive("shrink"),
          .early_look_way_m = section.positive("early_look_way_m"),
          .tracking = read_convergence(section.section("tracking")),
          .rough = read_convergence(section.section("rough"))};
}

}  // namespace

WindowRegistration::WindowRegistration(const RectifiedStereo& stereo,
                                       const LaserMap& map,
                                       int max_keyframes,
                                       const Config& config)
    : config_(config),
      map_(map),
      problem_(stereo, max_keyframes, config_.problem),
      alignment_(map, config_.association, config_.alignment),
      nearest_(map) {}

void WindowRegistration::synchronize(const SessionDatabase& database, const Pose& T_map_odom) {
  problem_.synchronize(database, database.placed(database.window(), T_map_odom));
  nearest_.forget([this](LandmarkId landmark) { return !problem_.has(landmark); });
}

void WindowRegistration::clear(const SessionDatabase& database) {
  problem_.synchronize(database, {});
  shift_profile_.reset();
}

double WindowRegistration::gate_m(const PoseWithCovariance& prior) const {
  const auto& rounds = config_.rounds;
  const double sigma_m = landmark_sigma(problem_.positions(), prior);
  return std::clamp(rounds.gate_sigmas * sigma_m, rounds.tracking_gate_m, rounds.widest_gate_m);
}

RigidAlignment::Result WindowRegistration::align(const PosePrior& prior,
                                                 double gate_m,
                                                 const std::optional<Pose>& guess) {
  const Pose T_map_body = problem_.pose(prior.keyframe);
  std::optional<Pose> T_new_old;
  if (guess) T_new_old = *guess * inverse(T_map_body);
  const RigidAlignment::Gates gates{gate_m, config_.rounds.final_gate_m};
  const RigidAlignment::Result aligned = alignment_.align(
      problem_.landmarks(), {T_map_body, prior.estimate.covariance}, gates, T_new_old);
  problem_.move(aligned.T_new_old);
  return aligned;
}

void WindowRegistration::restrain(const PosePrior& before) {
  problem_.set_prior(
      before.keyframe, before.estimate.T_map_body, before.estimate.covariance.inverse());
}

// They end where the pose comes back to a place where it was: it has settled, or goes to and fro
// for ever.
MapFit WindowRegistration::fit(const Prediction& prediction,
                               const SessionDatabase& database,
                               const Acceptance& acceptance) {
  const auto& rounds = config_.rounds;
  const Convergence& until = prediction.is_rough ? rounds.rough : rounds.tracking;
  const KeyframeId newest = database.newest().item.id;
  MapFit fit;
  std::vector<WindowLandmark> landmarks;
  std::vector<Pose> visited;  // at the final gate
  double gate_m = rounds.tracking_gate_m;
  for (int round = 0; round < until.max_rounds; ++round) {
    const Pose before = problem_.pose(newest);
    landmarks = problem_.landmarks();
    fit.association = associate(landmarks, map_, gate_m, config_.association, nearest_);
    if (!acceptance.check_matches(fit.association)) break;
    if (shift_profile_) shift_profile_->widen(fit.association.matches);
    problem_.set_matches(fit.association.matches);
    fit.add(problem_.solve(until.iterations, until.min_decrease));
    if (!fit.is_solved) break;
    fit.T_map_body = problem_.pose(newest);
    fit.moved_m = distance(before, fit.T_map_body);
    if ((round > 0 || !config_.shift_profile.is_used) && gate_m <= rounds.final_gate_m) {
      visited.push_back(before);
      const auto is_here = [&](const Pose& place) {
        return distance(place, fit.T_map_body) < until.settled_m;
      };
      if (std::ranges::any_of(visited, is_here)) break;
    }
    if (round == 0 && config_.shift_profile.is_used) {
      shift_profile_ = shift_profile(fit.association.matches, prediction.is_found);
    }
    gate_m = std::max(rounds.final_gate_m, rounds.shrink * gate_m);
  }
  if (!fit.is_solved) return fit;
  fit.recent = associate(
      recent(database, std::move(landmarks)), map_, gate_m, config_.association, nearest_);
  fit.constraint =
      analyze_map_constraint(fit.association.matches, config_.degeneracy.normal_sigma_rad);
  fit.median_residual =
      median_residual(fit.association.matches, problem_.positions(), config_.association);
  fit.innovation_sigmas = acceptance.innovation_sigmas(prediction.newest, fit.T_map_body);
  return fit;
}

ShiftProfile WindowRegistration::shift_profile(const std::vector<MapMatch>& matches,
                                               bool is_found) const {
  ShiftProfileConfig config = config_.shift_profile;
  if (is_found) config.steps = config.found_steps;
  return {seen_without_map(problem_.landmarks(), matches, config_.problem.map_kernel),
          map_,
          config_.rounds.final_gate_m,
          config_.association,
          config,
          alignment_.rival_score()};
}

// Those that no older keyframe has seen; none as long as there is no older one.
std::vector<WindowLandmark> WindowRegistration::recent(
    const SessionDatabase& database, std::vector<WindowLandmark> landmarks) const {
  const std::vector<KeyframeId> window = database.window();
  const int older = static_cast<int>(window.size()) - config_.recent_keyframes;
  if (older <= 0) return {};
  const auto seen = database.seen_by(std::span(window).first(static_cast<std::size_t>(older)));
  std::erase_if(landmarks, [&seen](const WindowLandmark& landmark) {
    return std::ranges::binary_search(seen, landmark.id);
  });
  return landmarks;
}

std::size_t WindowRegistration::memory_bytes() const {
  const auto observations = static_cast<std::size_t>(problem_.observations());
  return observations * kBytesPerObservation + nearest_.memory_bytes();
}

WindowRegistration::Config read_window_registration_config(ConfigReader section) {
  return {.problem = read_window_problem_config(section.section("problem")),
          .association = read_association_config(section.section("association")),
          .shift_profile = read_shift_profile_config(section.section("shift_profile")),
          .alignment = read_rigid_alignment_config(section.section("alignment")),
          .degeneracy = read_degeneracy_config(section.section("degeneracy")),
          .rounds = read_rounds(section.section("rounds")),
          .recent_keyframes = section.integer("recent_keyframes", 1, 1000)};
}

}  // namespace fleetloc
