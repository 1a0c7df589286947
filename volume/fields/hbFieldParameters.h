#pragma once

#include <map>
#include <string>
#include <string_view>

/// The parameters of a field that is asked for as "NAME[,parameter=value...]", each with its text.
using hbFieldParameters = std::map<std::string, std::string>;

namespace hb {

/// NAME: what stands before the first comma.
std::string_view fieldName(std::string_view specification);

/// `defaults` with the values that `specification` gives. Throws hbError for a parameter that is not among them.
hbFieldParameters parseFieldParameters(std::string_view specification, const hbFieldParameters& defaults);

/// A parameter's value; throws hbError unless it is a number from `lo` to `hi`.
double fieldNumber(const hbFieldParameters& parameters, const std::string& key, double lo, double hi);

/// "NAME,parameter=value,..." with every parameter.
std::string fieldSpecification(std::string_view name, const hbFieldParameters& parameters);

} // namespace hb
