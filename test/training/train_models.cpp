// train_models TABLE TRAINING... [-- UNSEEN...]
// Trains the models of the encoding `compact` on recordings of fleetloc-replay --samples and writes
// them as idl/compact_models.txt is one. Prints what blocks and their datagrams take before and
// after, and what each row of models takes.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <fstream>
#include <iostream>
#include <numeric>
#include <string>
#include <vector>

#include "shared/link/datagrams.hpp"
#include "test/training/recording.hpp"

namespace fleetloc {
namespace {

/// Bits of one model in one block.
struct Run {
  double weight = 1.0;
  std::vector<bool> bits;
};

using Shares = std::vector<std::uint8_t>;  // by place

double surprise(std::uint32_t probability_of_zero, bool bit) {
  constexpr double kOne = 1U << BitModel::kProbabilityBits;
  return -std::log2((bit ? kOne - probability_of_zero : probability_of_zero) / kOne);
}

// Adds what a bit costs with a model, which learns it [bits].
double cost(BitModel& model, bool bit) {
  const double bits = surprise(model.probability_of_zero(), bit);
  model.learn(bit);
  return bits;
}

// Of all runs, each from the same start, and of `surprises` blocks in which the bit is set, and as
// many in which it is clear: what is rare must stay possible.
double cost(const std::vector<Run>& runs, std::uint8_t share, double surprises) {
  const std::uint32_t zero = BitModel(share).probability_of_zero();
  double bits = surprises * (surprise(zero, false) + surprise(zero, true));
  for (const Run& run : runs) {
    BitModel model(share);
    double sum = 0.0;
    for (const bool bit : run.bits) sum += cost(model, bit);
    bits += run.weight * sum;
  }
  return bits;
}

// The cost has one minimum.
std::uint8_t best_share(const std::vector<Run>& runs, double surprises) {
  int low = 1;
  int high = 255;
  while (low < high) {
    const int middle = (low + high) / 2;
    const auto at = [&](int share) {
      return cost(runs, static_cast<std::uint8_t>(share), surprises);
    };
    if (at(middle) <= at(middle + 1)) {
      high = middle;
    } else {
      low = middle + 1;
    }
  }
  return static_cast<std::uint8_t>(low);
}

/// By place. Every recording counts as one, however long it is.
std::vector<std::vector<Run>> runs_by_model(const std::vector<Recording>& recordings,
                                            const ModelList& list) {
  std::vector<std::vector<Run>> runs(list.size());
  for (const Recording& recording : recordings) {
    const double weight = 1.0 / static_cast<double>(recording.blocks.size());
    for (const BitRecord& block : recording.blocks) {
      std::vector<std::vector<bool>> bits(list.size());
      for (const ModelledBit& one : block.bits) bits[one.model].push_back(one.bit);
      for (std::size_t place = 0; place < bits.size(); ++place) {
        if (!bits[place].empty()) runs[place].push_back({weight, std::move(bits[place])});
      }
    }
  }
  return runs;
}

/// What each model costs in a block [bits].
std::vector<double> costs(const BitRecord& block, const Shares& shares) {
  std::vector<BitModel> models;
  for (const std::uint8_t share : shares) models.emplace_back(share);
  std::vector<double> bits(shares.size());
  for (const ModelledBit& one : block.bits) bits[one.model] += cost(models[one.model], one.bit);
  return bits;
}

/// Means over the blocks of one kind [bytes].
struct Size {
  double block = 0.0;
  double wire = 0.0;
};

Size mean_size(const Recording& recording, BitRecord::Kind kind, const Shares& shares) {
  Size sum;
  double count = 0.0;
  for (const BitRecord& block : recording.blocks) {
    if (block.kind != kind) continue;
    const std::vector<double> bits = costs(block, shares);
    const double bytes = std::ceil(
        std::accumulate(bits.begin(), bits.end(), static_cast<double>(block.raw_bits)) / 8.0);
    const auto payload = block.payload_bytes - block.block_bytes + static_cast<std::size_t>(bytes);
    const std::vector<std::size_t> datagrams = datagram_sizes(payload);
    sum.block += bytes;
    sum.wire += static_cast<double>(std::accumulate(datagrams.begin(), datagrams.end(), 0UL));
    ++count;
  }
  return {sum.block / count, sum.wire / count};
}

std::size_t count_of(const Recording& recording, BitRecord::Kind kind) {
  return static_cast<std::size_t>(std::ranges::count(recording.blocks, kind, &BitRecord::kind));
}

void print_sizes(const char* set, const Recording& recording, const std::vector<Shares>& tables) {
  for (const auto kind : {BitRecord::Kind::kSubmap, BitRecord::Kind::kCorrections}) {
    const std::size_t count = count_of(recording, kind);
    if (count == 0) continue;
    std::printf("%-8s %-24s %-11s %5zu",
                set,
                recording.name.c_str(),
                kind == BitRecord::Kind::kSubmap ? "submaps" : "corrections",
                count);
    const Size untrained = mean_size(recording, kind, tables.front());
    for (const Shares& shares : tables) {
      const Size size = mean_size(recording, kind, shares);
      std::printf("  %7.1f %7.1f %5.1f %%",
                  size.block,
                  size.wire,
                  100.0 * (size.block / untrained.block - 1.0));
    }
    std::printf("\n");
  }
}

// Means over all blocks in which the row was used, of all recordings.
void print_rows(const std::vector<Recording>& recordings,
                const ModelList& list,
                const std::vector<Shares>& tables) {
  std::vector<std::vector<double>> sums(tables.size(), std::vector<double>(list.size()));
  double count[2] = {0.0, 0.0};
  for (const Recording& recording : recordings) {
    for (const BitRecord& block : recording.blocks) {
      ++count[block.kind == BitRecord::Kind::kSubmap ? 0 : 1];
      for (std::size_t table = 0; table < tables.size(); ++table) {
        const std::vector<double> bits = costs(block, tables[table]);
        for (std::size_t place = 0; place < bits.size(); ++place) sums[table][place] += bits[place];
      }
    }
  }
  std::printf("\nbits of a block:\n");
  for (const ModelList::Row& row : list.rows()) {
    std::printf("%-40s", row.name.c_str());
    for (const std::vector<double>& sum : sums) {
      const auto first = sum.begin() + static_cast<std::ptrdiff_t>(row.first);
      std::printf(" %8.2f",
                  std::accumulate(first, first + static_cast<std::ptrdiff_t>(row.size), 0.0) /
                      count[row.name.starts_with("submap") ? 0 : 1]);
    }
    std::printf("\n");
  }
}

void write_table(std::ostream& out, const ModelList& list, const Shares& shares) {
  out << "# How the models of the encoding `compact` start in every block: see README.md. Written "
         "by\n"
         "# train_models (test/README.md). A name, and how likely each model's bit is set, in "
         "1/256.\n"
         "# Models that a row leaves out start at 128.\n";
  for (const ModelList::Row& row : list.rows()) {
    std::size_t size = row.size;
    while (size > 1 && shares[row.first + size - 1] == 128) --size;
    out << row.name;
    for (std::size_t i = 0; i < size; ++i) out << ' ' << int{shares[row.first + i]};
    out << '\n';
  }
}

/// The start of each model in `models`, by place.
Shares shares_of(CompactModels models) {
  Shares shares;
  for_each_row(models, [&](const std::string&, std::span<BitModel> row) {
    for (const BitModel& model : row) {
      constexpr std::uint32_t kOne = 1U << BitModel::kProbabilityBits;
      shares.push_back(static_cast<std::uint8_t>((kOne - model.probability_of_zero()) / 128));
    }
  });
  return shares;
}

struct Arguments {
  std::string table;
  std::vector<Recording> training, unseen;
};

void run(const Arguments& arguments) {
  CompactModels models;
  const ModelList list(models);
  Shares trained(list.size(), 128);
  constexpr double kSurpriseShare = 0.01;  // of the blocks
  const double surprises = kSurpriseShare * static_cast<double>(arguments.training.size());
  const auto runs = runs_by_model(arguments.training, list);
  for (std::size_t place = 0; place < runs.size(); ++place) {
    if (!runs[place].empty()) trained[place] = best_share(runs[place], surprises);
  }
  std::ofstream table(arguments.table);
  write_table(table, list, trained);
  if (!table.flush()) throw std::runtime_error(arguments.table + ": cannot be written");

  const std::vector<Shares> tables{
      Shares(list.size(), 128), shares_of(trained_models()), std::move(trained)};
  std::printf("bytes of block and datagram, and change: all models at 1/2; as built; as trained\n");
  for (const Recording& recording : arguments.training) print_sizes("training", recording, tables);
  for (const Recording& recording : arguments.unseen) print_sizes("unseen", recording, tables);
  print_rows(arguments.training, list, tables);
}

}  // namespace
}  // namespace fleetloc

int main(int argc, char** argv) {
  if (argc < 3) {
    std::cerr << "usage: train_models TABLE TRAINING... [-- UNSEEN...]\n";
    return 2;
  }
  try {
    fleetloc::Arguments arguments{.table = argv[1], .training = {}, .unseen = {}};
    auto* recordings = &arguments.training;
    for (const std::string& argument : std::vector<std::string>(argv + 2, argv + argc)) {
      if (argument == "--") {
        recordings = &arguments.unseen;
      } else {
        recordings->push_back(fleetloc::read_recording(argument));
      }
    }
    fleetloc::run(arguments);
  } catch (const std::exception& error) {
    std::cerr << "train_models: " << error.what() << '\n';
    return 1;
  }
  return 0;
}
