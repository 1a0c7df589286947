// hbvol's benchmarks. Google Benchmark's own options choose and report: --benchmark_filter=REGEX, --benchmark_out=FILE
// (JSON), --benchmark_repetitions=N.

#include <benchmark/benchmark.h>

int main(int count, char** arguments) {
  benchmark::Initialize(&count, arguments);
  if (benchmark::ReportUnrecognizedArguments(count, arguments)) return 2;
  // What a figure depends on beside the machine, which the library names by itself. (Its library_build_type is that of
  // Debian's benchmark library.)
  benchmark::AddCustomContext("hbvol_version", HBVOL_VERSION);
  benchmark::AddCustomContext("hbvol_compiler", HBVOL_COMPILER);
  benchmark::AddCustomContext("hbvol_build_type", HBVOL_BUILD_TYPE);
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
}
