#pragma once

#include <string>
#include <string_view>
#include <vector>

/// The vector instructions that the sampling kernels use. The best set the processor has is chosen by itself.
namespace hb {

/// The sets that this processor has and the kernels were built for, best first ("AVX3", "AVX2", "SSE4", ...: the names
/// are Highway's). Not while another thread evaluates.
std::vector<std::string> instructionSets();

/// The one in use.
std::string instructionSet();

/// Uses that one, or again the best one for an empty name: for tests and measurements. Values do not depend on it. Not
/// while another thread evaluates. Throws hbError for a set that instructionSets() lacks.
void useInstructionSet(std::string_view name);

} // namespace hb
