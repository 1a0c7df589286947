#include "raycast/hbInput.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>

#include <fmt/format.h>

#include "raycast/hbFullGrid.h"
#include "sparsegrid/hbCombinationSparseGrid.h"
#include "sparsegrid/hbSemiNodalGrid.h"
#include "volume/hbError.h"
#include "volume/hbVolumeField.h"

namespace fs = std::filesystem;

namespace {

/// Whether a file is meant to be an `.hbv` file: by its name, or by what it begins with.
bool isContainer(const fs::path& path) {
  if (path.extension() == ".hbv") return true;
  std::array<char, 4> start{};
  std::ifstream file(path, std::ios::binary);
  file.read(start.data(), start.size());
  return file && std::equal(start.begin(), start.end(), hb::kContainerMagic.begin(),
                            [](char a, std::uint8_t b) { return std::uint8_t(a) == b; });
}

} // namespace

hbInput hbInput::open(const std::string& name, const hbReadOptions& options, hbProgress& progress) {
  hbInput input;
  input.name = name;
  if (name.starts_with(kFieldPrefix)) {
    input.analytic = hbAnalyticField::create(std::string_view(name).substr(kFieldPrefix.size()));
    return input;
  }
  const fs::path path(name);
  std::error_code none;
  const bool isFile = fs::is_regular_file(path, none);
  if (isFile) input.fileBytes = fs::file_size(path, none);
  // Nothing but files is opened here: reading from a pipe would wait for its writer.
  if (isFile && isContainer(path)) {
    input.container =
        std::make_shared<const hbContainerReader>(path, hbSparseGridFile::chunkTypes(), options.memoryLimit);
    if (!hbSparseGridFile::isIn(*input.container))
      throw hbError(fmt::format("{}: expected a sparse grid, found an .hbv file without one", name));
    input.sparse = std::make_shared<const hbSparseGridFile>(hbSparseGridFile::read(*input.container));
    input.fileBytes = input.container->header().totalSize;
    return input;
  }
  input.volume = std::make_shared<const hbVolume>(hb::readVolume(path, options, progress));
  return input;
}

std::string hbInput::representation() const { return volume ? "volume" : analytic ? "analytic" : "sparse"; }

const hbGeometry& hbInput::geometry() const {
  return volume ? volume->geometry() : analytic ? analytic->geometry() : sparse->grid.geometry();
}

int hbInput::components() const { return volume ? volume->components() : analytic ? 1 : sparse->grid.components(); }

hbEngine hbInput::engine(hbEngine asked) const {
  if (asked != hbEngine::automatic) return asked;
  if (!sparse) return hbEngine::full;
  return hbSemiNodalGrid::fits(sparse->grid.indexSet()) ? hbEngine::seminodal : hbEngine::direct;
}

double hbInput::fieldBytes(hbEngine asked) const {
  if (!sparse) return 0.0;
  const hbEngine chosen = engine(asked);
  const hbIndexSet& set = sparse->grid.indexSet();
  if (chosen == hbEngine::full) return hb::fullGridBytes(sparse->grid);
  // At most: copies in two orders of axes, and the form that iso-surfaces are shaded with.
  if (chosen == hbEngine::lattice)
    return 2.0 * double(sizeof(float)) * double(set.storedValues()) * components() +
           (hbSemiNodalGrid::fits(set) ? hbSemiNodalGrid::bytes(set, components()) : 0.0);
  if (chosen == hbEngine::seminodal) return hbSemiNodalGrid::bytes(set, components());
  return chosen == hbEngine::combination ? hbCombinationSparseGrid::bytes(set, components()) : 0.0;
}

std::shared_ptr<const hbField> hbInput::field(hbEngine asked, std::optional<double> nonFinite,
                                              hbProgress& progress) const {
  const hbEngine chosen = engine(asked);
  if (chosen != hbEngine::full && !sparse)
    throw hbError(fmt::format("{}: the engine {} cannot evaluate {}; compress it first, or use the engine full", name,
                              hb::engineName(chosen), volume ? "a plain volume" : "an analytic field"));
  if (volume) return std::make_shared<const hbVolumeField>(*volume, volume->chooseValueMap(), nonFinite);
  if (analytic) return analytic;
  if (chosen == hbEngine::full)
    return std::make_shared<const hbVolumeField>(hb::extractFullGrid(sparse->grid, progress), sparse->grid.valueMap());
  if (chosen == hbEngine::seminodal) return std::make_shared<const hbSemiNodalGrid>(sparse->grid);
  if (chosen == hbEngine::combination) return std::make_shared<const hbCombinationSparseGrid>(sparse->grid);
  return {sparse, &sparse->grid};
}
