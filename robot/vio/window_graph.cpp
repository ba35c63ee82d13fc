#include "robot/vio/window_graph.hpp"

#include <algorithm>

namespace fleetloc {
namespace {

// Beyond these, a first-order correction of a preintegration is too coarse.
constexpr double kGyroscopeBiasStep = 2e-3;      // [rad/s]
constexpr double kAccelerometerBiasStep = 2e-2;  // [m/s^2]

FirstEstimate first_estimate_of(const GraphKeyframe& keyframe) {
  return {keyframe.first_pose ? &*keyframe.first_pose : nullptr,
          keyframe.first_speed_bias ? &*keyframe.first_speed_bias : nullptr};
}

GraphFactor inertial_factor(GraphKeyframe& first, GraphKeyframe& second) {
  return {
      std::make_unique<ImuFactor>(
          *second.from_previous, first_estimate_of(first), first_estimate_of(second)),
      {first.pose.data(), first.speed_bias.data(), second.pose.data(), second.speed_bias.data()}};
}

std::vector<LandmarkView> views_of(const WindowGraph& graph, LandmarkId id) {
  std::vector<LandmarkView> views;
  for (const GraphKeyframe& keyframe : graph.keyframes) {
    if (const StereoObservation* seen = find_observation(keyframe.observations, id)) {
      views.push_back({pose_from(keyframe.pose.data()), *seen});
    }
  }
  return views;
}

}  // namespace

const StereoObservation* find_observation(const std::vector<StereoObservation>& observations,
                                          LandmarkId id) {
  const auto found = std::lower_bound(
      observations.begin(),
      observations.end(),
      id,
      [](const StereoObservation& seen, LandmarkId wanted) { return seen.landmark < wanted; });
  return found != observations.end() && found->landmark == id ? &*found : nullptr;
}

NavState state_of(const GraphKeyframe& keyframe) {
  return nav_state_from(keyframe.pose.data(), keyframe.speed_bias.data());
}

ResidualBlock block_of(const GraphFactor& factor, const ceres::LossFunction* loss) {
  return {factor.cost.get(), loss, factor.parameters};
}

ResidualBlock block_of(const MarginalizationPrior& prior) {
  ResidualBlock block{&prior, nullptr, {}};
  for (const PriorState& state : prior.states()) {
    block.parameters.push_back(state.values);
  }
  return block;
}

void append(WindowGraph& graph, GraphKeyframe keyframe) {
  for (const StereoObservation& observation : keyframe.observations) {
    ++graph.landmarks[observation.landmark].observations;
  }
  graph.keyframes.push_back(std::move(keyframe));
}

void triangulate_inactive(WindowGraph& graph, const TriangulationLimits& limits) {
  for (auto& [id, landmark] : graph.landmarks) {
    if (landmark.is_active()) {
      continue;
    }
    const auto p_odom = triangulate(views_of(graph, id), graph.stereo, limits);
    landmark.triangulated = p_odom.has_value();
    if (p_odom.has_value()) {
      landmark.p_odom = {p_odom->x(), p_odom->y(), p_odom->z()};
    }
  }
}

void relinearize_preintegrations(WindowGraph& graph) {
  for (std::size_t i = 1; i < graph.keyframes.size(); ++i) {
    Preintegration& preintegration = *graph.keyframes[i].from_previous;
    const ImuBias bias = state_of(graph.keyframes[i - 1]).bias;
    const ImuBias& at = preintegration.bias();
    if ((bias.gyroscope - at.gyroscope).norm() > kGyroscopeBiasStep ||
        (bias.accelerometer - at.accelerometer).norm() > kAccelerometerBiasStep) {
      preintegration = preintegration.relinearized(bias);
    }
  }
}

std::vector<GraphFactor> inertial_factors(WindowGraph& graph) {
  std::vector<GraphFactor> factors;
  for (std::size_t i = 1; i < graph.keyframes.size(); ++i) {
    factors.push_back(inertial_factor(graph.keyframes[i - 1], graph.keyframes[i]));
  }
  return factors;
}

std::vector<VisualFactor> visual_factors(WindowGraph& graph, double pixel_sigma) {
  std::vector<VisualFactor> factors;
  for (std::size_t i = 0; i < graph.keyframes.size(); ++i) {
    GraphKeyframe& keyframe = graph.keyframes[i];
    const PoseParameters* first = first_estimate_of(keyframe).pose;
    for (const StereoObservation& observation : keyframe.observations) {
      GraphLandmark& landmark = graph.landmarks.at(observation.landmark);
      if (!landmark.is_active()) {
        continue;
      }
      VisualFactor visual;
      visual.factor.parameters = {keyframe.pose.data(), landmark.p_odom.data()};
      visual.keyframe = i;
      visual.landmark = observation.landmark;
      const StereoNoise noise{pixel_sigma};
      if (observation.disparity > 0.0) {
        visual.factor.cost =
            std::make_unique<StereoReprojectionFactor>(observation, graph.stereo, noise, first);
      } else {
        visual.factor.cost =
            std::make_unique<MonoReprojectionFactor>(observation, graph.stereo, noise, first);
      }
      factors.push_back(std::move(visual));
    }
  }
  return factors;
}

}  // namespace fleetloc
