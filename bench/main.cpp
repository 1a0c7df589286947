// hbvol's benchmarks. Google Benchmark's own options choose and report: --benchmark_filter=REGEX, --benchmark_out=FILE
// (JSON), --benchmark_repetitions=N. The environment variable HBVOL_INSTRUCTION_SET names another instruction set than
// the best one the processor has.

#include <cstdio>
#include <cstdlib>

#include <benchmark/benchmark.h>

#include "volume/hbError.h"
#include "volume/hbInstructionSet.h"

int main(int count, char** arguments) {
  benchmark::Initialize(&count, arguments);
  if (benchmark::ReportUnrecognizedArguments(count, arguments)) return 2;
  // What a figure depends on beside the machine, which the library names by itself. (Its library_build_type is that of
  // Debian's benchmark library.)
  benchmark::AddCustomContext("hbvol_version", HBVOL_VERSION);
  benchmark::AddCustomContext("hbvol_compiler", HBVOL_COMPILER);
  benchmark::AddCustomContext("hbvol_build_type", HBVOL_BUILD_TYPE);
  try {
    const char* wanted = std::getenv("HBVOL_INSTRUCTION_SET");
    hb::useInstructionSet(wanted ? wanted : "");
  } catch (const hbError& error) {
    std::fprintf(stderr, "hbvol_bench: error: %s\n", error.what());
    return 1;
  }
  benchmark::AddCustomContext("hbvol_instruction_set", hb::instructionSet());
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
}
