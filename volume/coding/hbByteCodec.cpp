#include "volume/coding/hbByteCodec.h"

#include <algorithm>
#include <cstring>
#include <memory>
#include <new>

#include <fmt/format.h>
#include <zstd.h>

#include "volume/hbError.h"

namespace {

constexpr int kLevel = 3;
/// Decoding step, and the block of planesZstd: four planes of 128 KiB.
constexpr std::size_t kStep = std::size_t{512} << 10U;
constexpr std::size_t kElement = 4;
/// 8 MiB, which RFC 8878 asks every decoder to support and advises encoders not to exceed. kLevel needs 2 MiB.
constexpr int kWindowLogMax = 23;

/// planes[p * n + i] = elements[4 i + p] for the n whole elements, then the bytes left over.
void toPlanes(std::span<const std::byte> elements, std::byte* planes) {
  const std::size_t n = elements.size() / kElement;
  for (std::size_t p = 0; p < kElement; ++p)
    for (std::size_t i = 0; i < n; ++i) planes[p * n + i] = elements[kElement * i + p];
  std::copy(elements.begin() + std::ptrdiff_t(kElement * n), elements.end(), planes + kElement * n);
}

void fromPlanes(std::span<const std::byte> planes, std::byte* elements) {
  const std::size_t n = planes.size() / kElement;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t p = 0; p < kElement; ++p) elements[kElement * i + p] = planes[p * n + i];
  std::copy(planes.begin() + std::ptrdiff_t(kElement * n), planes.end(), elements + kElement * n);
}

struct Free {
  void operator()(ZSTD_CCtx* context) const { ZSTD_freeCCtx(context); }
  void operator()(ZSTD_DCtx* context) const { ZSTD_freeDCtx(context); }
};

/// zstd refuses only for want of memory here: the parameters are constants within its limits.
std::size_t checked(std::size_t result) {
  if (ZSTD_isError(result)) throw hbError(fmt::format("zstd: {}", ZSTD_getErrorName(result)));
  return result;
}

/// Feeds `input` to the frame, which ends with it where `last`; false when `out` has no room for it.
bool compressStep(ZSTD_CCtx* context, std::span<const std::byte> input, bool last, ZSTD_outBuffer& out) {
  ZSTD_inBuffer in{input.data(), input.size(), 0};
  for (;;) {
    const std::size_t left = checked(ZSTD_compressStream2(context, &out, &in, last ? ZSTD_e_end : ZSTD_e_continue));
    if (last ? left == 0 : in.pos == in.size) return true;
    if (out.pos == out.size) return false;
  }
}

} // namespace

std::optional<std::vector<std::byte>> hb::encodeBytes(hbCodec codec, std::span<const std::byte> bytes) {
  if (codec == hbCodec::stored || bytes.size() < 2) return std::nullopt;
  const std::unique_ptr<ZSTD_CCtx, Free> context(ZSTD_createCCtx());
  if (!context) throw std::bad_alloc();
  checked(ZSTD_CCtx_setParameter(context.get(), ZSTD_c_compressionLevel, kLevel));
  checked(ZSTD_CCtx_setPledgedSrcSize(context.get(), bytes.size()));

  // Room for one byte less than there are: what does not fit is not smaller.
  std::vector<std::byte> packed(bytes.size() - 1);
  ZSTD_outBuffer out{packed.data(), packed.size(), 0};
  std::vector<std::byte> planes(codec == hbCodec::planesZstd ? std::min(kStep, bytes.size()) : 0);
  for (std::size_t done = 0; done < bytes.size();) {
    std::span<const std::byte> step = bytes.subspan(done, std::min(kStep, bytes.size() - done));
    done += step.size();
    if (codec == hbCodec::planesZstd) {
      toPlanes(step, planes.data());
      step = {planes.data(), step.size()};
    }
    if (!compressStep(context.get(), step, done == bytes.size(), out)) return std::nullopt;
  }
  packed.resize(out.pos);
  return packed;
}

bool hb::canDecode(hbCodec codec, std::uint16_t version) {
  return version == kCodecVersion &&
         (codec == hbCodec::stored || codec == hbCodec::zstd || codec == hbCodec::planesZstd);
}

std::vector<std::byte> hb::decodeBytes(hbCodec codec, std::uint16_t version, const hbByteSource& source,
                                       std::uint64_t rawSize, std::uint64_t memoryLimit, const std::string& what) {
  if (!canDecode(codec, version))
    throw hbError(fmt::format("{}: expected a codec from 0 to 2 in version {}, found codec {} in version {}", what,
                              kCodecVersion, std::uint16_t(codec), version));
  if (rawSize > memoryLimit)
    throw hbError(
        fmt::format("{}: expected at most {} bytes of memory to be needed, found {}", what, memoryLimit, rawSize));

  std::vector<std::byte> raw(rawSize);
  std::size_t done = 0; // bytes of raw that are final
  const auto expectRoom = [&](std::size_t count) {
    if (count > raw.size() - done)
      throw hbError(fmt::format("{}: expected {} bytes when unpacked, found more", what, rawSize));
  };
  const auto expectAll = [&] {
    if (done != raw.size())
      throw hbError(fmt::format("{}: expected {} bytes when unpacked, found {}", what, rawSize, done));
  };

  if (codec == hbCodec::stored) {
    for (auto piece = source(); !piece.empty(); piece = source()) {
      expectRoom(piece.size());
      std::memcpy(raw.data() + done, piece.data(), piece.size());
      done += piece.size();
    }
    expectAll();
    return raw;
  }

  const std::unique_ptr<ZSTD_DCtx, Free> context(ZSTD_createDCtx());
  if (!context) throw std::bad_alloc();
  checked(ZSTD_DCtx_setParameter(context.get(), ZSTD_d_windowLogMax, kWindowLogMax));
  std::vector<std::byte> step(std::clamp<std::size_t>(raw.size(), 1, kStep));
  std::size_t filled = 0;
  const auto flush = [&] {
    if (codec == hbCodec::planesZstd)
      fromPlanes({step.data(), filled}, raw.data() + done);
    else
      std::copy_n(step.begin(), filled, raw.begin() + std::ptrdiff_t(done));
    done += filled;
    filled = 0;
  };

  bool ended = false;
  for (auto piece = source(); !piece.empty(); piece = source()) {
    ZSTD_inBuffer in{piece.data(), piece.size(), 0};
    // All of the piece was taken and, as zstd.h says, nothing waits inside unless the output was full.
    bool drained = false;
    while (!drained) {
      if (ended)
        throw hbError(fmt::format("{}: expected nothing after the end of the zstd frame, found more bytes", what));
      ZSTD_outBuffer out{step.data() + filled, step.size() - filled, 0};
      const std::size_t result = ZSTD_decompressStream(context.get(), &out, &in);
      if (ZSTD_isError(result))
        throw hbError(fmt::format("{}: expected a zstd frame with a window of at most {} MiB, found: {}", what,
                                  1 << (kWindowLogMax - 20), ZSTD_getErrorName(result)));
      ended = result == 0;
      filled += out.pos;
      expectRoom(filled);
      if (filled == step.size()) flush();
      drained = in.pos == in.size && (ended || out.pos < out.size);
    }
  }
  if (!ended) throw hbError(fmt::format("{}: expected a whole zstd frame, found its beginning only", what));
  flush();
  expectAll();
  return raw;
}
