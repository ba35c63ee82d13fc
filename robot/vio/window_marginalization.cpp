#include <algorithm>

#include "robot/vio/window_graph.hpp"

namespace fleetloc {
namespace {

// The factors that become the prior, and their parameter blocks.
struct LeavingPart {
  std::vector<GraphFactor> factors;
  std::vector<ResidualBlock> blocks;
  std::vector<const double*> landmarks;
};

bool leaves(const WindowGraph& graph, LandmarkId id) {
  return find_observation(graph.keyframes.front().observations, id) != nullptr &&
         find_observation(graph.keyframes.back().observations, id) == nullptr;
}

LeavingPart leaving_part(WindowGraph& graph,
                         const SlidingWindow::Config& config,
                         const ceres::LossFunction* loss) {
  LeavingPart part;
  if (graph.prior != nullptr) {
    part.blocks.push_back(block_of(*graph.prior));
  }
  std::vector<GraphFactor> inertial = inertial_factors(graph);
  part.factors.push_back(std::move(inertial.front()));
  part.blocks.push_back(block_of(part.factors.back()));
  for (VisualFactor& visual : visual_factors(graph, config.noise.pixel_sigma)) {
    if (leaves(graph, visual.landmark)) {
      part.factors.push_back(std::move(visual.factor));
      part.blocks.push_back(block_of(part.factors.back(), loss));
    }
  }
  for (const auto& [id, landmark] : graph.landmarks) {
    if (landmark.is_active() && leaves(graph, id)) {
      part.landmarks.push_back(landmark.p_odom.data());
    }
  }
  return part;
}

bool touched(const LeavingPart& part, const double* values) {
  return std::any_of(part.blocks.begin(), part.blocks.end(), [values](const ResidualBlock& block) {
    return std::find(block.parameters.begin(), block.parameters.end(), values) !=
           block.parameters.end();
  });
}

// Poses, speeds and biases of the remaining keyframes in the prior. Their first estimates are
// fixed: from now on every factor takes its Jacobian at these values.
std::vector<PriorState> pin_remaining(WindowGraph& graph, const LeavingPart& part) {
  std::vector<PriorState> states;
  const auto pin = [&](auto& values, auto& first) {
    if (touched(part, values.data())) {
      if (!first.has_value()) {
        first = values;
      }
      states.push_back({values.data(),
                        Eigen::Map<const Eigen::VectorXd>(
                            first->data(), static_cast<Eigen::Index>(first->size()))});
    }
  };
  for (std::size_t i = 1; i < graph.keyframes.size(); ++i) {
    GraphKeyframe& keyframe = graph.keyframes[i];
    pin(keyframe.pose, keyframe.first_pose);
    pin(keyframe.speed_bias, keyframe.first_speed_bias);
  }
  return states;
}

// The gradient, as it would be with every state at its first estimate.
void move_to_first_estimates(const std::vector<PriorState>& states, NormalEquations& system) {
  Eigen::VectorXd moved(system.g.size());
  Eigen::Index row = 0;
  for (const PriorState& state : states) {
    moved.segment(row, state.tangent_size()) = difference(state, state.values);
    row += state.tangent_size();
  }
  system.g -= system.H * moved;
}

void forget_oldest(WindowGraph& graph) {
  for (const StereoObservation& seen : graph.keyframes.front().observations) {
    if (leaves(graph, seen.landmark)) {
      graph.landmarks.at(seen.landmark).observations = 0;
    } else {
      --graph.landmarks.at(seen.landmark).observations;
    }
  }
  graph.keyframes.pop_front();
  graph.keyframes.front().from_previous.reset();
  for (GraphKeyframe& keyframe : graph.keyframes) {
    std::erase_if(keyframe.observations, [&graph](const StereoObservation& seen) {
      return graph.landmarks.at(seen.landmark).observations == 0;
    });
  }
  std::erase_if(graph.landmarks, [](const auto& item) { return item.second.observations == 0; });
  drop_stale_corrections(graph);
}

}  // namespace

void marginalize_oldest(WindowGraph& graph, const SlidingWindow::Config& config) {
  const ceres::HuberLoss huber(config.huber_sigmas);
  const LeavingPart part = leaving_part(graph, config, &huber);
  GraphKeyframe& oldest = graph.keyframes.front();
  std::vector<PriorState> states = pin_remaining(graph, part);
  std::vector<ParameterBlock> kept{{oldest.pose.data(), 6}, {oldest.speed_bias.data(), 9}};
  for (const PriorState& state : states) {
    kept.push_back({state.values, state.tangent_size()});
  }
  NormalEquations system =
      marginalize_leading(schur_complement(part.blocks, kept, part.landmarks), 15);
  move_to_first_estimates(states, system);
  project_out(gauge_directions(states), system);
  graph.prior = std::make_unique<MarginalizationPrior>(std::move(states), system.H, system.g);
  forget_oldest(graph);
}

}  // namespace fleetloc
