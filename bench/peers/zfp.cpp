// zfp at a number of bytes: hbvol_peer_zfp IN.nrrd BYTES OUT.nrrd (doc/peers.md).
//
// zfp has no mode "best within so many bytes" but four ways of saying how much to keep. Of each the finest setting that
// fits is tried, and the one of the least root mean square error kept. Bytes are those of the whole stream with zfp's
// own header, so that it can be read with nothing else known.

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "bench/peers/peer.h"
#include "report/hbErrorStatistics.h"
#include "report/hbMedian.h"
#include "volume/hbVolumeReader.h"
#include "volume/hbVolumeWriter.h"

// Last: its global names (int8, ...) would be shadowed by ours.
#include <zfp.h>

namespace {

/// How much to keep. The larger `detail`, the larger the stream and the less the error.
struct Setting {
  zfp_mode mode;
  int detail; ///< Accuracy: minus the tolerance's exponent; precision: bit planes; rate: bits a block; reversible: 0.
};

/// Of 32-bit floats. A rate below one exponent and one bit a block is none.
constexpr int kCoarsestAccuracy = -140, kFinestAccuracy = 149, kMostPlanes = 32, kLeastBlockBits = 10;

std::vector<float> samplesOf(const hbVolume& volume, const std::string& name) {
  if (volume.components() != 1 || volume.type() != hbSampleType::float32)
    throw hbError(name + ": expected 32-bit floats of one component");
  const hbSize3 size = volume.geometry().size;
  std::vector<float> samples;
  samples.reserve(std::size_t(volume.geometry().samples()));
  std::vector<double> row(static_cast<std::size_t>(size.x));
  for (std::int64_t z = 0; z < size.z; ++z)
    for (std::int64_t y = 0; y < size.y; ++y) {
      volume.row(0, y, z, 0, row);
      for (const double value : row) {
        if (!std::isfinite(value))
          throw peer::Refused(fmt::format("{}: expected finite values, found {}", name, value));
        samples.push_back(float(value));
      }
    }
  return samples;
}

/// The field of these samples: zfp's blocks have as many dimensions as axes are not flat, at least one.
zfp_field fieldOf(std::vector<float>& samples, const hbSize3& size) {
  std::vector<std::size_t> sides;
  for (int d = 0; d < 3; ++d)
    if (size[d] > 1) sides.push_back(std::size_t(size[d]));
  sides.resize(3);
  zfp_field field{};
  field.type = zfp_type_float;
  field.data = samples.data();
  field.nx = std::max<std::size_t>(sides[0], 1);
  field.ny = sides[1];
  field.nz = sides[2];
  return field;
}

class Codec {
public:
  Codec(std::vector<float> samples, const hbSize3& size)
      : samples_(std::move(samples)), decoded_(samples_.size()), size_(size), stream_(zfp_stream_open(nullptr)) {
    field_ = fieldOf(samples_, size);
    blockSize_ = 1U << (2 * zfp_field_dimensionality(&field_));
  }

  std::size_t blocks() const {
    return ((field_.nx + 3) / 4) * ((std::max<std::size_t>(field_.ny, 1) + 3) / 4) *
           ((std::max<std::size_t>(field_.nz, 1) + 3) / 4);
  }

  /// The stream's bytes.
  std::size_t compress(const Setting& setting) {
    set(setting);
    buffer_.resize(std::max(buffer_.size(), zfp_stream_maximum_size(stream_.get(), &field_) + sizeof(std::uint64_t)));
    const Bits bits(stream_open(buffer_.data(), buffer_.size()));
    zfp_stream_set_bit_stream(stream_.get(), bits.get());
    zfp_stream_rewind(stream_.get());
    bytes_ = 0;
    if (zfp_write_header(stream_.get(), &field_, ZFP_HEADER_FULL) > 0) bytes_ = zfp_compress(stream_.get(), &field_);
    if (bytes_ == 0) throw hbError("compression failed");
    return bytes_;
  }

  /// What the last stream holds, by nothing but that stream.
  const std::vector<float>& decompress() {
    const Bits bits(stream_open(buffer_.data(), bytes_));
    const Stream stream(zfp_stream_open(bits.get()));
    zfp_field found{};
    if (zfp_read_header(stream.get(), &found, ZFP_HEADER_FULL) == 0) throw hbError("the stream's header is damaged");
    zfp_field field = fieldOf(decoded_, size_);
    if (zfp_decompress(stream.get(), &field) == 0) throw hbError("decompression failed");
    return decoded_;
  }

  double error() const {
    hbErrorStatistics errors;
    for (std::size_t i = 0; i < samples_.size(); ++i) errors.add(double(samples_[i]), double(decoded_[i]));
    return errors.rmse();
  }

  /// In zfp's own terms: tolerance in values, bit planes, bits a sample, 0.
  double parameter(const Setting& setting) const {
    if (setting.mode == zfp_mode_fixed_accuracy) return std::ldexp(1.0, -setting.detail);
    if (setting.mode == zfp_mode_fixed_rate) return double(setting.detail) / double(blockSize_);
    return double(setting.detail);
  }

private:
  struct Close {
    void operator()(zfp_stream* stream) const { zfp_stream_close(stream); }
    void operator()(bitstream* bits) const { stream_close(bits); }
  };
  using Stream = std::unique_ptr<zfp_stream, Close>;
  using Bits = std::unique_ptr<bitstream, Close>;

  void set(const Setting& setting) {
    const double value = parameter(setting);
    switch (setting.mode) {
    case zfp_mode_fixed_accuracy:
      zfp_stream_set_accuracy(stream_.get(), value);
      break;
    case zfp_mode_fixed_precision:
      zfp_stream_set_precision(stream_.get(), uint(setting.detail));
      break;
    case zfp_mode_fixed_rate:
      zfp_stream_set_rate(stream_.get(), value, zfp_type_float, zfp_field_dimensionality(&field_), zfp_false);
      break;
    default:
      zfp_stream_set_reversible(stream_.get());
    }
  }

  std::vector<float> samples_, decoded_;
  hbSize3 size_;
  Stream stream_;
  zfp_field field_{};
  unsigned blockSize_ = 1; ///< Samples.
  std::vector<unsigned char> buffer_;
  std::size_t bytes_ = 0;
};

const char* nameOf(zfp_mode mode) {
  switch (mode) {
  case zfp_mode_fixed_accuracy:
    return "accuracy";
  case zfp_mode_fixed_precision:
    return "precision";
  case zfp_mode_fixed_rate:
    return "rate";
  default:
    return "reversible";
  }
}

/// The finest setting in [coarsest, finest] whose stream has at most `most` bytes, by bisection; none where not even
/// the coarsest has. `least` becomes the fewest bytes seen.
std::optional<Setting> finest(Codec& codec, zfp_mode mode, int coarsest, int finest, std::size_t most,
                              std::size_t& least) {
  const auto fits = [&](int detail) {
    const std::size_t bytes = codec.compress({mode, detail});
    least = std::min(least, bytes);
    return bytes <= most;
  };
  if (!fits(coarsest)) return std::nullopt;
  while (coarsest < finest) {
    const int middle = coarsest + (finest - coarsest + 1) / 2;
    if (fits(middle))
      coarsest = middle;
    else
      finest = middle - 1;
  }
  return Setting{mode, coarsest};
}

Setting best(Codec& codec, std::size_t most) {
  std::size_t least = std::numeric_limits<std::size_t>::max();
  // A stream of so many bits a block is larger than what is asked for.
  const int mostBits =
      int(std::clamp<std::uint64_t>(8 * std::uint64_t(most) / codec.blocks() + 1, kLeastBlockBits, ZFP_MAX_BITS));
  const std::optional<Setting> candidates[]{
      finest(codec, zfp_mode_fixed_accuracy, kCoarsestAccuracy, kFinestAccuracy, most, least),
      finest(codec, zfp_mode_fixed_precision, 1, kMostPlanes, most, least),
      finest(codec, zfp_mode_fixed_rate, kLeastBlockBits, mostBits, most, least),
      finest(codec, zfp_mode_reversible, 0, 0, most, least)};
  std::optional<Setting> chosen;
  double leastError = std::numeric_limits<double>::infinity();
  for (const auto& candidate : candidates) {
    if (!candidate) continue;
    codec.compress(*candidate);
    codec.decompress();
    const double error = codec.error();
    if (chosen && error >= leastError) continue;
    chosen = candidate;
    leastError = error;
  }
  if (!chosen) throw peer::Refused(fmt::format("expected at least {} bytes, found {}", least, most));
  return *chosen;
}

nlohmann::ordered_json work(char** arguments) {
  const std::string in = arguments[0], out = arguments[2];
  const std::size_t most = peer::wholeNumber(arguments[1], "BYTES", 1, std::uint64_t(1) << 60);
  const hbVolume volume = hb::readVolume(in);
  Codec codec(samplesOf(volume, in), volume.geometry().size);
  const Setting setting = best(codec, most);

  constexpr int kRepeats = 3;
  std::vector<double> compressing, decompressing;
  std::size_t bytes = 0;
  for (int i = 0; i < kRepeats; ++i) {
    compressing.push_back(peer::seconds([&] { bytes = codec.compress(setting); }));
    decompressing.push_back(peer::seconds([&] { codec.decompress(); }));
  }
  const double error = codec.error();
  hb::writeVolume(hbVolume::fromSamples(volume.geometry(), codec.decompress()), out);
  return {{"name", "zfp"},
          {"version", ZFP_VERSION_STRING},
          {"bytes", bytes},
          {"mode", nameOf(setting.mode)},
          {"parameter", codec.parameter(setting)},
          {"rmse", error},
          {"threads", 1},
          {"seconds_compress", hb::median(compressing)},
          {"seconds_decompress", hb::median(decompressing)}};
}

} // namespace

int main(int count, char** arguments) {
  return peer::run(count, arguments, "zfp", ZFP_VERSION_STRING, "IN.nrrd BYTES OUT.nrrd", work);
}
