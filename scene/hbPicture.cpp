#include "scene/hbPicture.h"

#include <cstddef>

#include <fmt/format.h>

#include "scene/hbScene.h"
#include "volume/hbError.h"

std::vector<float>& hbPicture::add(const std::string& name, float fill) {
  auto& channel = channels[name];
  channel.assign(std::size_t(width) * std::size_t(height), fill);
  return channel;
}

const std::vector<float>* hbPicture::find(const std::string& name) const {
  const auto at = channels.find(name);
  return at == channels.end() ? nullptr : &at->second;
}

void hbPicture::validate(const std::string& what) const {
  constexpr int kMax = hbScene::kMaxPictureSide;
  if (width < 1 || height < 1 || width > kMax || height > kMax)
    throw hbError(
        fmt::format("{}: expected a picture of 1 to {} pixels a side, found {} x {}", what, kMax, width, height));
  if (channels.empty())
    throw hbError(fmt::format("{}: expected a picture with at least one channel, found none", what));
  for (const auto& [name, values] : channels)
    if (values.size() != std::size_t(width) * std::size_t(height))
      throw hbError(
          fmt::format("{}: channel {}: expected {} x {} values, found {}", what, name, width, height, values.size()));
}
