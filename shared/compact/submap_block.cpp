#include "shared/compact/submap_block.hpp"

#include "shared/coding/range_decoder.hpp"
#include "shared/coding/range_encoder.hpp"
#include "shared/compact/submap_block_coder.hpp"
#include "shared/compact/trained_models.hpp"

namespace fleetloc {

std::vector<std::uint8_t> encode_block(const CompactSubmap& submap, const RectifiedStereo& stereo) {
  RangeEncoder encoder;
  CompactSubmap coded = submap;
  SubmapModels models = trained_models().submap;
  SubmapBlockCoder(encoder, models, coded, stereo).code();
  return encoder.finish();
}

std::optional<CompactSubmap> decode_block(std::span<const std::uint8_t> bytes,
                                          const StrictRotation& newest_rotation,
                                          std::uint32_t newest_id,
                                          const RectifiedStereo& stereo) {
  CompactSubmap submap;
  submap.newest_rotation = newest_rotation;
  submap.keyframes.resize(1);
  submap.keyframes.back().id = newest_id;
  RangeDecoder decoder(bytes);
  SubmapModels models = trained_models().submap;
  if (!SubmapBlockCoder(decoder, models, submap, stereo).code() || decoder.is_overrun()) {
    return std::nullopt;
  }
  return submap;
}

}  // namespace fleetloc
