#pragma once

#include <atomic>
#include <cstdint>
#include <string_view>

/// How long work tells how far it is, and learns that it should stop.
///
/// Library calls take one by reference, `hbProgress::none()` by default. All members may be called from any thread.
/// The base class counts and shows nothing.
class hbProgress {
public:
  hbProgress() = default;
  hbProgress(const hbProgress&) = delete;
  hbProgress& operator=(const hbProgress&) = delete;
  virtual ~hbProgress() = default;

  /// Starts a task of `total` units; `what` is a few words for a person ("reading", "ray casting"), `unit` the name of
  /// a unit.
  virtual void begin(std::string_view what, std::int64_t total, std::string_view unit) {
    (void)what, (void)unit;
    done_ = 0;
    total_ = total;
  }

  /// Counts `units` as done; throws hbCancelled once cancel() was called.
  void advance(std::int64_t units);

  /// Makes every later advance() throw hbCancelled. Safe in a signal handler.
  void cancel() { cancelled_ = true; }
  bool cancelled() const { return cancelled_; }

  /// A shared one that shows nothing.
  static hbProgress& none();

protected:
  /// Called by advance() with the units done so far; may be called concurrently.
  virtual void show(std::int64_t done, std::int64_t total) { (void)done, (void)total; }

private:
  std::atomic<std::int64_t> done_{0};
  std::atomic<std::int64_t> total_{0};
  std::atomic<bool> cancelled_{false};
};
