#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>

#include "shared/coding/bit_model.hpp"
#include "shared/coding/integer_model.hpp"

namespace fleetloc {

// for_each_row(name, models, visit) calls visit(name, row) for every row of a table of models: a
// std::span<BitModel> of neighbours, with a name of its own that begins with `name`. All that goes
// through the models of a block goes this way, so the names are written down once. Structures of
// models have their own overload, beside them.

template <typename Visit>
void for_each_row(const std::string& name, BitModel& model, const Visit& visit) {
  visit(name, std::span<BitModel>(&model, 1));
}

template <std::size_t N, typename Visit>
void for_each_row(const std::string& name, std::array<BitModel, N>& models, const Visit& visit) {
  visit(name, std::span<BitModel>(models));
}

template <typename Visit>
void for_each_row(const std::string& name, IntegerModel& model, const Visit& visit) {
  model.for_each_row(name, visit);
}

/// Elements are numbered: name.0, name.1, ...
template <typename Models, std::size_t N, typename Visit>
void for_each_row(const std::string& name, std::array<Models, N>& models, const Visit& visit) {
  for (std::size_t i = 0; i < N; ++i)
    for_each_row(name + "." + std::to_string(i), models[i], visit);
}

}  // namespace fleetloc
