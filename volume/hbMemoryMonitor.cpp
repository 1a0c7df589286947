#include "volume/hbMemoryMonitor.h"

#include <chrono>
#include <fstream>
#include <string>

std::int64_t hbMemoryMonitor::anonymousBytes() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;)
    if (word == "RssAnon:") {
      std::int64_t kilobytes = 0;
      status >> kilobytes;
      return kilobytes * 1024;
    }
  return 0;
}

hbMemoryMonitor::hbMemoryMonitor() : start_(anonymousBytes()), peak_(start_) {
  thread_ = std::thread([this] {
    while (!stop_) {
      look();
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
  });
}

hbMemoryMonitor::~hbMemoryMonitor() {
  stop_ = true;
  thread_.join();
}

void hbMemoryMonitor::look() {
  const std::int64_t now = anonymousBytes();
  std::int64_t before = peak_;
  while (now > before && !peak_.compare_exchange_weak(before, now)) {
  }
}

std::int64_t hbMemoryMonitor::growth() {
  look();
  return peak_ - start_;
}
