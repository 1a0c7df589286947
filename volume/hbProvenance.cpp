#include "volume/hbProvenance.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "volume/hbByteWriter.h"
#include "volume/hbError.h"

void hbProvenance::validate(const std::string& what) const {
  if (json.size() > kMaxBytes)
    throw hbError(fmt::format("{}: expected at most {} bytes of JSON, found {}", what, kMaxBytes, json.size()));
  // Checks without building a document: neither deep nesting nor long texts cost memory.
  if (!nlohmann::json::accept(json)) throw hbError(fmt::format("{}: expected JSON, found another text", what));
}

std::vector<std::byte> hbProvenance::encode() const {
  validate("provenance");
  hbByteWriter out;
  out.bytes(std::as_bytes(std::span(json)));
  return out.take();
}

hbProvenance hbProvenance::decode(std::span<const std::byte> bytes, const std::string& what) {
  hbProvenance provenance{{reinterpret_cast<const char*>(bytes.data()), bytes.size()}};
  provenance.validate(what);
  return provenance;
}
