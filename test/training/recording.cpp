#include "test/training/recording.hpp"

#include <fstream>
#include <map>
#include <optional>
#include <stdexcept>

#include <idl/localization.h>

#include "shared/compact/correction_coder.hpp"
#include "shared/compact/submap_block_coder.hpp"
#include "shared/compact/submap_sample.hpp"
#include "shared/wire/cdr.hpp"
#include "shared/wire/session_codec.hpp"

namespace fleetloc {
namespace {

Bytes octets(const std::string& hexadecimal) {
  Bytes out;
  for (std::size_t i = 0; i + 1 < hexadecimal.size(); i += 2) {
    out.push_back(static_cast<std::uint8_t>(std::stoi(hexadecimal.substr(i, 2), nullptr, 16)));
  }
  return out;
}

/// Reads samples one after the other: submaps need the calibration of their session.
class BlockReader {
 public:
  std::optional<BitRecord> read(const std::string& topic, const Bytes& payload);

 private:
  BitRecord read_submap(const Bytes& payload);
  std::optional<BitRecord> read_answer(const Bytes& payload);

  std::map<RobotId, RectifiedStereo> stereo_;
};

std::optional<BitRecord> BlockReader::read(const std::string& topic, const Bytes& payload) {
  if (topic == "session") {
    if (const auto session = decode_robot_session(payload))
      stereo_[session->robot] = session->stereo;
  }
  if (topic == "submap") return read_submap(payload);
  if (topic == "localization") return read_answer(payload);
  return std::nullopt;
}

BitRecord BlockReader::read_submap(const Bytes& payload) {
  const SubmapSample sample = decode_submap_sample(payload).value();
  CompactSubmap submap;
  submap.newest_rotation = rotation_of(sample.pose);
  submap.keyframes.resize(1);
  submap.keyframes.back().id = static_cast<std::uint32_t>(sample.keyframe);
  BitRecord record{.kind = BitRecord::Kind::kSubmap,
                   .block_bytes = sample.block.size(),
                   .payload_bytes = payload.size()};
  CompactModels models = trained_models();
  const ModelList list(models);
  RecordingDecoder decoder(sample.block, list, record);
  if (!SubmapBlockCoder(decoder, models.submap, submap, stereo_.at(sample.robot)).code()) {
    throw std::runtime_error("a submap that cannot be decoded");
  }
  return record;
}

std::optional<BitRecord> BlockReader::read_answer(const Bytes& payload) {
  const auto sample = from_cdr<wire::LocalizationResult>(payload, 2).value();
  const auto& block = sample.corrections();
  if (block.empty()) return std::nullopt;
  CodedCorrection coded{.anchor = sample.keyframe()};
  BitRecord record{.kind = BitRecord::Kind::kCorrections,
                   .block_bytes = block.size(),
                   .payload_bytes = payload.size()};
  CompactModels models = trained_models();
  const ModelList list(models);
  RecordingDecoder decoder(block, list, record);
  if (!CorrectionCoder(decoder, models.correction, coded).code()) {
    throw std::runtime_error("corrections that cannot be decoded");
  }
  return record;
}

}  // namespace

Recording read_recording(const std::filesystem::path& file) {
  std::ifstream lines(file);
  Recording recording{.name = file.stem().string(), .blocks = {}};
  BlockReader reader;
  for (std::string topic, payload; lines >> topic >> payload;) {
    if (auto block = reader.read(topic, octets(payload))) {
      recording.blocks.push_back(std::move(*block));
    }
  }
  if (recording.blocks.empty()) throw std::runtime_error(file.string() + ": no blocks");
  return recording;
}

}  // namespace fleetloc
