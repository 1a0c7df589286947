#pragma once

#include <cstdint>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "report/hbSparseCompression.h"

namespace app {

/// What `compress` says of a file it made: for the statistics file.
nlohmann::ordered_json compressionStatistics(const hbSparseCompression::Result& result, std::uint64_t inputBytes,
                                             std::uint64_t outputBytes);

/// The same for a person, on stdout.
void printCompression(const std::string& out, const nlohmann::ordered_json& stats,
                      const hbSparseCompression::Result& result);

} // namespace app
