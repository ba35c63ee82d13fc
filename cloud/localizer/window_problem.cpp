#include "cloud/localizer/window_problem.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "cloud/localizer/slot_pool.hpp"
#include "cloud/localizer/tilt_factor.hpp"
#include "shared/factors/relative_pose_factor.hpp"
#include "shared/factors/reprojection_factor.hpp"

namespace fleetloc {
namespace {

constexpr std::size_t kPoseSize = 7;
constexpr std::size_t kPointSize = 3;

ceres::Problem::Options problem_options() {
  ceres::Problem::Options options;
  options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.enable_fast_removal = true;
  options.disable_all_safety_checks = true;
  return options;
}

void write_pose(const Pose& T, double* values) {
  const PoseParameters parameters = to_parameters(T);
  std::copy(parameters.begin(), parameters.end(), values);
}

bool is_same_observation(const StereoObservation& a, const StereoObservation& b) {
  return a.landmark == b.landmark && a.left == b.left && a.disparity == b.disparity;
}

// Whatever the revisions.
bool is_same_edge(const VirtualEdge& a, const VirtualEdge& b) {
  return a.from == b.from && a.to == b.to && a.T_from_to.p == b.T_from_to.p &&
         a.T_from_to.R.coeffs() == b.T_from_to.R.coeffs() && a.information == b.information;
}

constexpr double kRoundingVariance = 1.0 / 12.0;  // of a uniform error, in steps squared

}  // namespace

WindowProblem::WindowProblem(RectifiedStereo stereo, int max_keyframes, const Config& config)
    : stereo_(std::move(stereo)),
      config_(config),
      reprojection_loss_(config.reprojection_kernel),
      map_loss_(config.map_kernel),
      pose_pool_(std::make_unique<SlotPool>(static_cast<std::size_t>(max_keyframes), kPoseSize)),
      point_pool_(
          std::make_unique<SlotPool>(static_cast<std::size_t>(config.max_landmarks), kPointSize)),
      problem_(problem_options()) {}

WindowProblem::~WindowProblem() = default;

void WindowProblem::synchronize(const SessionDatabase& database,
                                const std::map<KeyframeId, Pose>& poses) {
  clear_prior();
  if (tilt_ != nullptr) problem_.RemoveResidualBlock(std::exchange(tilt_, nullptr));
  Edges wanted;
  for (const VirtualEdge* edge : database.spanning_edges()) {
    if (poses.contains(edge->from) && poses.contains(edge->to)) {
      wanted[{edge->from, edge->to}] = edge;
    }
  }
  remove_edges(wanted);
  remove_keyframes(database, poses);
  add_keyframes(database, poses);
  add_edges(wanted);
  add_observations(placed_landmarks(database, poses, stereo_));
  if (config_.use_tilt && !poses.empty()) {
    add_tilt(database.keyframe(poses.begin()->first).item);
  }
}

void WindowProblem::remove_edges(const Edges& wanted) {
  std::erase_if(edges_, [&](const auto& entry) {
    const auto& [key, node] = entry;
    const auto edge = wanted.find(key);
    const bool stays = edge != wanted.end() && is_same_edge(*edge->second, node.edge);
    if (!stays) problem_.RemoveResidualBlock(node.factor);
    return !stays;
  });
}

// Residual blocks are removed before their parameter blocks: Ceres would remove them in the order
// of their addresses.
void WindowProblem::remove_keyframes(const SessionDatabase& database,
                                     const std::map<KeyframeId, Pose>& poses) {
  for (auto node = keyframes_.begin(); node != keyframes_.end();) {
    const auto& [id, keyframe] = *node;
    // Most revisions of a keyframe change its estimate only, which is no measurement.
    const bool stays =
        poses.contains(id) &&
        std::ranges::equal(
            database.keyframe(id).item.observations, keyframe.observations, is_same_observation);
    if (stays) {
      ++node;
      continue;
    }
    for (std::size_t i = 0; i < keyframe.factors.size(); ++i) {
      if (keyframe.factors[i] == nullptr) continue;
      problem_.RemoveResidualBlock(keyframe.factors[i]);
      --landmarks_.at(keyframe.observations[i].landmark).observations;
      --observations_;
    }
    std::erase_if(edges_, [this, gone = id](const auto& entry) {
      const bool is_its_own = entry.first.first == gone || entry.first.second == gone;
      if (is_its_own) problem_.RemoveResidualBlock(entry.second.factor);
      return is_its_own;
    });
    problem_.RemoveParameterBlock(keyframe.pose);
    pose_pool_->give_back(keyframe.pose);
    node = keyframes_.erase(node);
  }
}

void WindowProblem::add_keyframes(const SessionDatabase& database,
                                  const std::map<KeyframeId, Pose>& poses) {
  for (const auto& [id, T_map_body] : poses) {
    const auto [place, is_new] = keyframes_.try_emplace(id);
    KeyframeNode& node = place->second;
    if (is_new) {
      const SubmapKeyframe& item = database.keyframe(id).item;
      node.pose = pose_pool_->take();
      node.pixel_sigma_px =
          std::hypot(config_.pixel_sigma_px, item.pixel_step_px * std::sqrt(kRoundingVariance));
      node.observations = item.observations;
      node.factors.assign(item.observations.size(), nullptr);
      problem_.AddParameterBlock(node.pose, kPoseSize, &manifold_);
    }
    write_pose(T_map_body, node.pose);
  }
}

void WindowProblem::add_edges(const Edges& wanted) {
  for (const auto& [key, edge] : wanted) {
    if (edges_.contains(key)) continue;
    const ceres::ResidualBlockId factor =
        problem_.AddResidualBlock(new RelativePoseFactor(edge->T_from_to, edge->information),
                                  nullptr,
                                  keyframes_.at(edge->from).pose,
                                  keyframes_.at(edge->to).pose);
    edges_[key] = {*edge, factor};
  }
}

void WindowProblem::add_observations(const LandmarkPositions& positions) {
  for (auto& [id, keyframe] : keyframes_) {
    for (std::size_t i = 0; i < keyframe.factors.size(); ++i) {
      const LandmarkId landmark = keyframe.observations[i].landmark;
      if (keyframe.factors[i] != nullptr || !positions.contains(landmark)) continue;
      add_observation(keyframe, i);
    }
  }
  for (auto landmark = landmarks_.begin(); landmark != landmarks_.end();) {
    if (landmark->second.observations == 0) {
      landmark = remove_landmark(landmark);
      continue;
    }
    const auto position = positions.find(landmark->first);
    if (position != positions.end()) {
      Eigen::Map<Eigen::Vector3d>{landmark->second.point} = position->second;
    }
    ++landmark;
  }
}

void WindowProblem::add_observation(KeyframeNode& keyframe, std::size_t index) {
  const StereoObservation& seen = keyframe.observations[index];
  const auto [place, is_new] = landmarks_.try_emplace(seen.landmark);
  LandmarkNode& landmark = place->second;
  if (is_new) {
    if (point_pool_->is_full()) {
      landmarks_.erase(place);
      return;
    }
    landmark.point = point_pool_->take();
    problem_.AddParameterBlock(landmark.point, kPointSize);
  }
  const StereoNoise noise{keyframe.pixel_sigma_px};
  ceres::CostFunction* factor = nullptr;
  if (seen.disparity > 0.0) {
    factor = new StereoReprojectionFactor(seen, stereo_, noise);
  } else {
    factor = new MonoReprojectionFactor(seen, stereo_, noise);
  }
  keyframe.factors[index] =
      problem_.AddResidualBlock(factor, &reprojection_loss_, keyframe.pose, landmark.point);
  ++landmark.observations;
  ++observations_;
}

std::map<LandmarkId, WindowProblem::LandmarkNode>::iterator WindowProblem::remove_landmark(
    std::map<LandmarkId, LandmarkNode>::iterator landmark) {
  set_match(landmark->second, nullptr);
  problem_.RemoveParameterBlock(landmark->second.point);
  point_pool_->give_back(landmark->second.point);
  return landmarks_.erase(landmark);
}

void WindowProblem::add_tilt(const SubmapKeyframe& oldest) {
  const Eigen::Vector3d up_body = oldest.T_odom_body.R.conjugate() * Eigen::Vector3d::UnitZ();
  const double sigma = std::hypot(oldest.tilt_sigma, config_.map_tilt_sigma_rad);
  tilt_ = problem_.AddResidualBlock(
      new TiltFactor(up_body, sigma), nullptr, keyframes_.at(oldest.id).pose);
}

WindowProblem::Config read_window_problem_config(ConfigReader section) {
  return {.pixel_sigma_px = section.positive("pixel_sigma_px"),
          .reprojection_kernel = section.positive("reprojection_kernel"),
          .map_kernel = section.positive("map_kernel"),
          .use_tilt = section.get<bool>("use_tilt"),
          .map_tilt_sigma_rad = section.positive("map_tilt_sigma_rad"),
          .max_landmarks = section.integer("max_landmarks", 100, 100000)};
}

}  // namespace fleetloc
