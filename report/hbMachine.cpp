#include "report/hbMachine.h"

#include <fstream>
#include <thread>

#include <sys/utsname.h>
#include <unistd.h>

#include "volume/hbInstructionSet.h"

namespace {

std::string processorName() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);)
    if (line.starts_with("model name")) {
      const std::size_t colon = line.find(": ");
      if (colon != std::string::npos) return line.substr(colon + 2);
    }
  return "unknown";
}

std::string systemName() {
  utsname name{};
  return ::uname(&name) == 0 ? std::string(name.sysname) + " " + name.release : "unknown";
}

} // namespace

hbMachine hbMachine::current() {
  return {
    processorName(), int(std::thread::hardware_concurrency()),
        std::uint64_t(::sysconf(_SC_PHYS_PAGES)) * std::uint64_t(::sysconf(_SC_PAGESIZE)), systemName(),
#if defined(__clang__)
        "clang " __clang_version__,
#else
        "GCC " __VERSION__,
#endif
        hb::instructionSet()
  };
}
