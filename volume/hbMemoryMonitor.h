#pragma once

#include <atomic>
#include <cstdint>
#include <thread>

/// Watches how far the process's anonymous memory grows while it lives, by looking every two milliseconds.
class hbMemoryMonitor {
public:
  hbMemoryMonitor();
  ~hbMemoryMonitor();
  hbMemoryMonitor(const hbMemoryMonitor&) = delete;
  hbMemoryMonitor& operator=(const hbMemoryMonitor&) = delete;

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
