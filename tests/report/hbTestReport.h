#pragma once

#include <filesystem>
#include <string>

#include <nlohmann/json.hpp>

namespace hb::test {

/// A made-up report of a comparison as `hbvol compare` writes it: two modes; the volume itself, two levels of sparse
/// and coarse grids and of zfp, whose coarser one failed; names that have to be escaped. The sparse grids' picture
/// error in mode "mip" is 0 at the finer level. Its pictures are named, not written.
nlohmann::ordered_json report();

/// A case of VTK in that report: of the volume itself, "image_only", faster than any other, with a picture RMSE of 14.5
/// levels of a byte and a mean L*u*v* distance that can be seen. Its picture is named, not written.
nlohmann::ordered_json vtkCase(const nlohmann::ordered_json& report, const std::string& mode);

/// That report with a fit by least squares at both levels, drawn by one engine; at the coarser level interpolation was
/// kept.
nlohmann::ordered_json fittedReport();

/// The same with the volume itself and one sparse grid, in one mode.
nlohmann::ordered_json smallReport();

/// Writes a picture of 24 x 16 pixels for each name in the report, each in a colour of its own.
void writePictures(const nlohmann::ordered_json& report, const std::filesystem::path& folder);

} // namespace hb::test
