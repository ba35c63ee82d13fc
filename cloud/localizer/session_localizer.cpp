#include "cloud/localizer/session_localizer.hpp"

#include <algorithm>
#include <cassert>
#include <iterator>
#include <utility>
#include <vector>

namespace fleetloc {
namespace {

constexpr std::size_t kBytesPerLandmark = 900;
constexpr int kMaxPlaces = 255;  // that an answer tells of

// Along each axis at least these standard deviations.
Matrix6d raised_to(double sigma_rad, double sigma_m, const Matrix6d& covariance) {
  const Vector6d least = diagonal_covariance(sigma_rad, sigma_m).diagonal();
  Matrix6d result = covariance;
  result.diagonal() += (least - covariance.diagonal()).cwiseMax(0.0);
  return result;
}

// Of a shift of the window on the level, as one of a body in it (right perturbation).
Matrix6d shift_covariance(const Eigen::Matrix2d& covariance_map, const Pose& T_map_body) {
  const Eigen::Matrix<double, 3, 2> R = T_map_body.R.toRotationMatrix().transpose().leftCols<2>();
  Matrix6d result = Matrix6d::Zero();
  result.bottomRightCorner<3, 3>() = R * covariance_map * R.transpose();
  return result;
}

}  // namespace

SessionLocalizer::SessionLocalizer(const RobotSession& session,
                                   std::shared_ptr<const LaserMap> map,
                                   const Config& config,
                                   std::shared_ptr<const MapPyramid> pyramid,
                                   const std::optional<MapRegion>& where)
    : map_(std::move(map)),
      config_(config),
      stereo_(session.stereo),
      database_(config_.database),
      registration_(session.stereo, *map_, config_.database.window, config_.registration),
      dead_reckoning_(session.start, config_.drift),
      acceptance_(config_.acceptance, config_.confirmation, config_.place_doubt),
      found_start_(config_.found_start) {
  if (!pyramid) return;
  std::optional<FirstPlace::Region> region;
  if (session.start) region = FirstPlace::region_of(*session.start, config_.first_place);
  if (region) dead_reckoning_ = DeadReckoning(std::nullopt, config_.drift);
  if (where && session.region) {
    region =
        FirstPlace::Region{.where = *where, .p_odom = session.region->p_odom, .has_borders = true};
  }
  const auto& rounds = config_.registration.rounds;
  first_place_.emplace(*map_,
                       std::move(pyramid),
                       registration_.alignment(),
                       RigidAlignment::Gates{rounds.widest_gate_m, rounds.final_gate_m},
                       config_.first_place,
                       region);
}

void SessionLocalizer::add(const Submap& submap) {
  has_news_ = true;
  database_.add(submap);
  dead_reckoning_.follow(database_.keyframes());
}

void SessionLocalizer::take_over(const SessionDatabase& database) {
  has_news_ = true;
  database_ = database;
  database_.forget_solutions();
  dead_reckoning_.follow(database_.keyframes());
}

// The localization on the cloud as the paper has it: a window of the database is moved into the map
// (eq. 12), its landmarks are associated with the map's points (eq. 13 to 15), and E_loc (eq. 16)
// is optimized.
LocalizationResult SessionLocalizer::localize() {
  assert(!database_.empty());
  system_.reset();
  const bool knows_more = first_place_ && search();
  const bool has_news = std::exchange(has_news_, false) || knows_more;
  if (!has_news && diagnostics_.rejection) return rejected(*diagnostics_.rejection, diagnostics_);
  const std::vector<KeyframeId> window = database_.window();
  const auto ready = acceptance_.check_window(dead_reckoning_.has_anchor(), window.size());
  if (!ready) return rejected(not_ready(ready.error()), diagnostics_of(window));

  registration_.synchronize(database_, dead_reckoning_.T_map_odom());
  const Prediction prediction = predict(window);
  if (!prediction.is_early) early_look_.reset();
  const std::optional<Look> looked = prediction.is_rough ? look(prediction) : early_look_;
  restrain(prediction.before);
  const MapFit fit = registration_.fit(prediction, database_, acceptance_);
  expected<Solution, Rejection> solution = accept(prediction, fit, looked);

  const LocalizationDiagnostics diagnostics = diagnostics_of(window, prediction, fit);
  const double travelled_m = dead_reckoning_.travelled_m(window.back());
  acceptance_.conclude(solution ? std::nullopt : std::optional(solution.error()), travelled_m);
  if (!solution) found_start_.judge(evidence_of(solution.error()), travelled_m);
  if (!solution) return rejected(solution.error(), diagnostics);
  if (prediction.is_early) early_look_ = looked;
  store(solution->newest);
  return localized(std::move(*solution), diagnostics);
}

// While there is no place, or none that is believed, or none but one that was found so far: one
// turn, of which the first only looks at what has been seen.
// @return whether more is known of the place now: another one, or the same from a longer window
bool SessionLocalizer::search() {
  const KeyframeId newest = database_.newest().item.id;
  if (has_found_start() && found_start_.is_wrong(dead_reckoning_.travelled_m(newest))) {
    give_up_found_start();
  }
  const double travelled_m = dead_reckoning_.travelled_m(newest);
  const bool has_place = dead_reckoning_.has_anchor() && !acceptance_.is_lost();
  if (has_place && !has_found_start()) return false;
  if (!first_place_->is_running()) {
    begin_search(travelled_m);
    return false;
  }
  const auto T_map_odom = first_place_->advance();
  if (!T_map_odom) return false;
  if (has_place && is_held(*T_map_odom)) return found_start_.confirm(search_way_m_);
  start_at(*T_map_odom);
  return true;
}

// Of a session that is searched for it is known whether places are left, or none is.
Rejection SessionLocalizer::not_ready(Rejection reason) const {
  if (reason != Rejection::kSearching || !first_place_) return reason;
  if (first_place_->is_off_map()) return Rejection::kNotCovered;
  return first_place_->is_ambiguous() ? Rejection::kAmbiguous : reason;
}

// What the robot has sent since the session was localized last: what came before has its place.
SessionDatabase SessionLocalizer::unexplained() const {
  SessionDatabase result = database_;
  result.forget_solutions();
  if (!localized_until_) return result;
  const auto first = result.keyframes().upper_bound(*localized_until_);
  if (first != result.keyframes().end()) result.forget_before(first->first);
  return result;
}

// With what is searched for in odom.
void SessionLocalizer::begin_search(double travelled_m) {
  const std::vector<KeyframeId> window = database_.window();
  const auto first =
      localized_until_ ? std::ranges::upper_bound(window, *localized_until_) : window.begin();
  if (first == window.end()) return;
  const double way_m = travelled_m - dead_reckoning_.travelled_m(*first);
  if (!first_place_->is_due(way_m, travelled_m)) return;
  const SessionDatabase seen = unexplained();
  if (acceptance_.is_lost()) first_place_->forget_region();
  WindowProblem problem(stereo_, config_.database.window, config_.registration.problem);
  problem.synchronize(seen, seen.placed(seen.window(), Pose{}));
  first_place_->begin({problem.landmarks(), seen.newest().item.T_odom_body}, travelled_m);
  search_way_m_ = way_m;
}

// What a longer window finds again was not unique by chance.
bool SessionLocalizer::is_held(const Pose& T_map_odom) const {
  const Pose& T_odom_body = database_.newest().item.T_odom_body;
  return is_same_place(dead_reckoning_.T_map_odom() * T_odom_body,
                       T_map_odom * T_odom_body,
                       config_.first_place.hypotheses);
}

// As a new session there, of what has not had a place so far.
void SessionLocalizer::start_at(const Pose& T_map_odom) {
  const KeyframeId newest = database_.newest().item.id;
  const Pose T_odom_body = database_.newest().item.T_odom_body;
  const auto& sigma = config_.found_start;
  const Matrix6d A = adjoint(T_odom_body);
  const double sigma_m = sigma.sigma_cells * first_place_->cell_m();
  const Matrix6d covariance = diagonal_covariance(sigma.sigma_rad, sigma_m);
  begin_anew(MapOdomEstimate{.T_map_odom = T_map_odom,
                             .covariance = A * covariance * A.transpose(),
                             .p_odom = T_odom_body.p});
  found_start_.begin(dead_reckoning_.travelled_m(newest), search_way_m_);
}

std::vector<PlaceHypotheses::Place> SessionLocalizer::possible_places() const {
  return first_place_ ? first_place_->ambiguous() : std::vector<PlaceHypotheses::Place>{};
}

void SessionLocalizer::give_up_found_start() {
  found_start_.give_up();
  begin_anew(std::nullopt);
}

void SessionLocalizer::begin_anew(const std::optional<MapOdomEstimate>& start) {
  database_ = unexplained();
  localized_until_.reset();
  first_place_->begin_anew();
  registration_.clear(database_);
  dead_reckoning_ = DeadReckoning(start, config_.drift);
  dead_reckoning_.follow(database_.keyframes());
  acceptance_ = Acceptance(config_.acceptance, config_.confirmation, config_.place_doubt);
  early_look_.reset();
}

// As long as the window has all that was localized, its place is looked for anew from the start
// pose on the way: what the first keyframes say rests on a few surfaces, which may fit elsewhere.
Prediction SessionLocalizer::predict(const std::vector<KeyframeId>& window) const {
  Prediction result;
  result.is_start = !dead_reckoning_.is_localized();
  result.is_early = dead_reckoning_.is_start_before(window);
  result.is_found = found_start_.exists() && (result.is_start || result.is_early);
  result.before = dead_reckoning_.before(window, database_);
  result.prior = dead_reckoning_.prior(window, database_);
  result.newest = dead_reckoning_.at(database_.newest().item);
  result.gate_m = registration_.gate_m(result.prior.estimate);
  const double tracking_gate_m = config_.registration.rounds.tracking_gate_m;
  if (result.is_early) {
    const auto& floors = config_.covariance_inflation;
    Matrix6d& start = result.before.estimate.covariance;
    start = raised_to(floors.start_floor_rad, floors.start_floor_m, start);
    if (result.gate_m > tracking_gate_m || is_look_due(window)) {
      result.prior = result.before;
      result.gate_m = registration_.gate_m(result.prior.estimate);
    }
  }
  result.is_rough = result.gate_m > tracking_gate_m;
  return result;
}

bool SessionLocalizer::is_look_due(const std::vector<KeyframeId>& window) const {
  if (!early_look_ || !std::ranges::binary_search(window, early_look_->keyframe)) return true;
  const double way_m = dead_reckoning_.travelled_m(window.back()) - early_look_->travelled_m;
  return way_m >= config_.registration.rounds.early_look_way_m;
}

// While the first place is unconfirmed, the one found last is a start as well.
SessionLocalizer::Look SessionLocalizer::look(const Prediction& prediction) {
  const KeyframeId keyframe = prediction.prior.keyframe;
  std::optional<Pose> guess;
  if (const auto& T_map_odom = acceptance_.unconfirmed_T_map_odom()) {
    guess = *T_map_odom * database_.keyframe(keyframe).item.T_odom_body;
  }
  const RigidAlignment::Result aligned =
      registration_.align(prediction.prior, prediction.gate_m, guess);
  return {.travelled_m = dead_reckoning_.travelled_m(database_.newest().item.id),
          .keyframe = keyframe,
          .rivals = aligned.rivals};
}

// By what is left of what was before the window. It has met errors that the window meets as well.
void SessionLocalizer::restrain(PosePrior before) {
  const auto& floors = config_.covariance_inflation;
  before.estimate.covariance += diagonal_covariance(floors.prior_floor_rad, floors.prior_floor_m);
  registration_.restrain(before);
}

// The place first: the window is linearized only where its covariance is of use.
expected<SessionLocalizer::Solution, Rejection> SessionLocalizer::accept(
    const Prediction& prediction, const MapFit& fit, const std::optional<Look>& looked) {
  const auto fits = acceptance_.check_fit(fit, prediction.is_start);
  if (!fits) return unexpected(fits.error());

  const WindowProblem& problem = registration_.problem();
  WindowSystem system = problem.system();
  Matrix6d other_places = looked ? rivals_of_newest(*looked) : Matrix6d::Zero();
  // What a start pose tells of the place, a search does not: it has to be seen in the map.
  if (prediction.is_found && !config_.registration.shift_profile.is_used) {
    const ShiftProfile profile =
        registration_.shift_profile(fit.association.matches, prediction.is_found);
    other_places += shift_covariance(profile.excess(), fit.T_map_body);
  }
  const auto stated = answer_covariance(
      problem, system, fit.constraint, config_.registration.degeneracy, prediction, other_places);
  const auto certain = acceptance_.check_certainty(stated, has_found_start());
  if (!certain) return unexpected(certain.error());

  const SubmapKeyframe& newest = database_.newest().item;
  TravelledPath path{dead_reckoning_.travelled_m(database_.window().front()),
                     dead_reckoning_.travelled_m(newest.id)};
  if (has_found_start()) {
    const Pose T_map_odom = fit.T_map_body * inverse(newest.T_odom_body);
    if (!first_place_->is_within_borders(T_map_odom)) return unexpected(Rejection::kNotCovered);
    if (first_place_->places_left() > 1) return unexpected(Rejection::kAmbiguous);
    if (!first_place_->is_only_one_left()) return unexpected(Rejection::kUnconfirmed);
    path.searched_m = found_start_.searched_m();
  }
  const auto confirmed = acceptance_.confirm(fit, prediction.newest, newest.T_odom_body, path);
  if (!confirmed) return unexpected(confirmed.error());
  return Solution{{fit.T_map_body, stated->covariance}, std::move(system)};
}

// Other places are those of the whole window: the newest pose moves rigidly with the keyframe.
Matrix6d SessionLocalizer::rivals_of_newest(const Look& looked) const {
  const WindowProblem& problem = registration_.problem();
  const Matrix6d A =
      adjoint(inverse(problem.pose(database_.newest().item.id)) * problem.pose(looked.keyframe));
  return A * looked.rivals * A.transpose();
}

void SessionLocalizer::store(const PoseWithCovariance& newest) {
  const WindowProblem& problem = registration_.problem();
  for (const auto& [id, T_map_body] : problem.poses()) database_.store_solution(id, T_map_body);
  for (const auto& [id, p_map] : problem.positions()) database_.store_solution(id, p_map);
  dead_reckoning_.restart(database_.newest().item, newest);
  localized_until_ = database_.newest().item.id;
  if (first_place_) first_place_->stop();
}

LocalizationResult SessionLocalizer::localized(Solution solution,
                                               const LocalizationDiagnostics& diagnostics) {
  diagnostics_ = diagnostics;
  const auto& floors = config_.covariance_inflation;
  LocalizationResult result = answer(LocalizationStatus::kLocalized);
  result.oldest_stamp = database_.keyframe(database_.window().front()).item.stamp;
  result.T_map_body = solution.newest.T_map_body;
  result.covariance =
      solution.newest.covariance + diagonal_covariance(floors.floor_rad, floors.floor_m);
  system_ = std::move(solution.system);
  return result;
}

LocalizationResult SessionLocalizer::rejected(Rejection reason,
                                              const LocalizationDiagnostics& diagnostics) {
  diagnostics_ = diagnostics;
  diagnostics_.rejection = reason;
  return answer(acceptance_.is_lost() ? LocalizationStatus::kLost : status_of(reason));
}

LocalizationResult SessionLocalizer::answer(LocalizationStatus status) const {
  const SubmapKeyframe& newest = database_.newest().item;
  LocalizationResult result;
  result.status = status;
  result.keyframe = newest.id;
  result.revision = newest.revision;
  result.stamp = newest.stamp;
  result.map_hash = map_->info().hash;
  result.places = places_left();
  return result;
}

int SessionLocalizer::places_left() const {
  const bool is_searched_for =
      !dead_reckoning_.has_anchor() || acceptance_.is_lost() || has_found_start();
  if (!first_place_ || !is_searched_for) return 0;
  if (first_place_->is_off_map() && !first_place_->is_ambiguous()) return 0;
  return std::min(static_cast<int>(first_place_->places_left()), kMaxPlaces);
}

std::optional<Correction> SessionLocalizer::correction(Duration round_trip) const {
  if (!system_) return std::nullopt;
  const auto window = database_.window();
  const int last = std::min(static_cast<int>(window.size()), config_.corrections.robot_window) - 1;
  if (last == 0) return std::nullopt;
  const Timestamp earlier = database_.keyframe(*std::prev(window.end(), last + 1)).item.stamp;
  const Duration interval = (database_.newest().item.stamp - earlier) / last;
  const int keyframes = correctable_keyframes(interval, round_trip, config_.corrections);
  if (keyframes == 0) return std::nullopt;
  const auto marginals = relative_marginals(*system_, keyframes, config_.corrections);
  if (!marginals) return std::nullopt;
  Correction correction = map_correction(*marginals, config_.corrections);
  if (correction.relative_poses.empty() && correction.landmarks.empty()) return std::nullopt;
  return correction;
}

std::size_t SessionLocalizer::memory_bytes() const {
  return sizeof(*this) + database_.memory_bytes() + registration_.memory_bytes() +
         database_.landmarks().size() * kBytesPerLandmark + (system_ ? system_->memory_bytes() : 0);
}

}  // namespace fleetloc
