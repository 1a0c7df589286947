#pragma once

#include <atomic>
#include <cstdint>
#include <thread>

namespace app {

/// Watches how far the process's anonymous memory grows while it lives, by looking every two milliseconds.
class MemoryMonitor {
public:
  MemoryMonitor();
  ~MemoryMonitor();
  MemoryMonitor(const MemoryMonitor&) = delete;
  MemoryMonitor& operator=(const MemoryMonitor&) = delete;

  /// The peak so far above what there was at the beginning, in bytes.
  std::int64_t growth();

  /// The process's anonymous memory now, in bytes (Linux: RssAnon).
  static std::int64_t anonymousBytes();

private:
  void look();

  std::int64_t start_;
  std::atomic<std::int64_t> peak_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

} // namespace app
