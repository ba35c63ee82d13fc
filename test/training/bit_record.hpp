#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "shared/coding/bit_model.hpp"
#include "shared/coding/range_decoder.hpp"
#include "shared/compact/trained_models.hpp"

namespace fleetloc {

/// One bit of a block, and which model it was coded with: a place in ModelList.
struct ModelledBit {
  std::uint16_t model = 0;
  bool bit = false;
};

/// All bits of a block.
struct BitRecord {
  enum class Kind { kSubmap, kCorrections };
  Kind kind{};
  std::vector<ModelledBit> bits{};
  std::size_t raw_bits = 0;
  std::size_t block_bytes = 0;    ///< as it was recorded
  std::size_t payload_bytes = 0;  ///< of its sample
};

/// The rows of the table of models, and the place of every model in it.
class ModelList {
 public:
  struct Row {
    std::string name;
    std::size_t first = 0;  ///< place of its first model
    std::size_t size = 0;
  };

  /// @param models  must outlive it
  explicit ModelList(CompactModels& models) {
    for_each_row(models, [&](const std::string& name, std::span<BitModel> row) {
      rows_.push_back({name, places_.size(), row.size()});
      for (BitModel& model : row) places_.emplace(&model, places_.size());
    });
  }

  [[nodiscard]] const std::vector<Row>& rows() const { return rows_; }
  [[nodiscard]] std::size_t size() const { return places_.size(); }
  [[nodiscard]] std::size_t place(const BitModel& model) const { return places_.at(&model); }

 private:
  std::vector<Row> rows_;
  std::unordered_map<const BitModel*, std::size_t> places_;
};

/// A decoder that writes down what it reads.
class RecordingDecoder {
 public:
  static constexpr bool kDecodes = true;

  /// @param bytes, models, record  must outlive it
  RecordingDecoder(std::span<const std::uint8_t> bytes, const ModelList& models, BitRecord& record)
      : decoder_(bytes), models_(models), record_(record) {}

  bool code(BitModel& model, bool /*ignored*/ = false) {
    const bool bit = decoder_.code(model);
    record_.bits.push_back({static_cast<std::uint16_t>(models_.place(model)), bit});
    return bit;
  }
  std::uint32_t code_raw(std::uint32_t /*ignored*/, int count) {
    record_.raw_bits += static_cast<std::size_t>(count);
    return decoder_.code_raw(0, count);
  }
  [[nodiscard]] bool is_overrun() const { return decoder_.is_overrun(); }

 private:
  RangeDecoder decoder_;
  const ModelList& models_;
  BitRecord& record_;
};

}  // namespace fleetloc
