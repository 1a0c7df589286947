// The progress bar, and what Ctrl-C does to it.

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <mutex>
#include <string>

#include <fmt/format.h>
#include <unistd.h>

#include "apps/Program.h"
#include "volume/hbOutputFile.h"

namespace {

using Clock = std::chrono::steady_clock;

/// One line on a terminal, redrawn five times a second from half a second on: what is done, the rate, the time left.
class ProgressBar final : public hbProgress {
public:
  ~ProgressBar() override { clear(); }

  void begin(std::string_view what, std::int64_t total, std::string_view unit) override {
    const std::lock_guard lock(mutex_);
    hbProgress::begin(what, total, unit);
    what_ = what;
    unit_ = unit;
    start_ = Clock::now();
    next_ = (start_ + kDelay).time_since_epoch().count();
  }

  void clear() {
    if (drawn_) std::fputs("\r\033[K", stderr);
    drawn_ = false;
  }

protected:
  void show(std::int64_t done, std::int64_t total) override {
    if (done < total && Clock::now().time_since_epoch().count() < next_) return;
    const std::lock_guard lock(mutex_);
    const auto now = Clock::now();
    if (done >= total) return clear();
    if (now.time_since_epoch().count() < next_) return; // another thread was first
    next_ = (now + kInterval).time_since_epoch().count();
    const double seconds = std::chrono::duration<double>(now - start_).count();
    const double share = total > 0 ? std::clamp(double(done) / double(total), 0.0, 1.0) : 0.0,
                 rate = double(done) / seconds;
    constexpr int kWidth = 24;
    const int full = int(share * kWidth);
    fmt::print(stderr, "\r\033[K{} [{:=<{}}{:<{}}] {:3.0f} %  {}/s  {:.0f} s left", what_, "", full, "", kWidth - full,
               100.0 * share, rateText(rate), share > 0.0 ? seconds * (1.0 - share) / share : 0.0);
    std::fflush(stderr);
    drawn_ = true;
  }

private:
  static constexpr std::chrono::milliseconds kDelay{500}, kInterval{200};

  std::string rateText(double rate) const {
    if (rate >= 1e6) return fmt::format("{:.1f} M {}", rate / 1e6, unit_);
    if (rate >= 1e3) return fmt::format("{:.1f} k {}", rate / 1e3, unit_);
    return fmt::format("{:.1f} {}", rate, unit_);
  }

  std::mutex mutex_;
  std::string what_, unit_;
  Clock::time_point start_;
  std::atomic<Clock::rep> next_{0};
  bool drawn_ = false;
};

hbProgress* active = nullptr;
bool onTerminal = false;
volatile std::sig_atomic_t patient = 0; ///< Whether the first interrupt waits for what is done about it.

// Work that looks at its progress stops at once and tidies up; a library that does not (a decoder, a blocked read) is
// given most of a second.
void onInterrupt(int) {
  active->cancel();
  if (patient != 0) {
    patient = 0;
    return;
  }
  ::signal(SIGALRM, [](int) {
    hb::removeTemporaryFiles();
    constexpr char kText[] = "\nhbvol: error: interrupted; nothing half-written is left\n";
    const std::size_t skip = onTerminal ? 0 : 1; // the line feed ends a progress bar
    [[maybe_unused]] const auto written = ::write(STDERR_FILENO, kText + skip, sizeof(kText) - 1 - skip);
    ::_exit(1);
  });
  ::ualarm(800000, 0);
}

} // namespace

namespace {
ProgressBar& progressBar() {
  static ProgressBar bar;
  return bar;
}
} // namespace

void app::clearProgress() noexcept { progressBar().clear(); }

hbProgress& app::progress() {
  static hbProgress silent;
  static hbProgress& chosen = ::isatty(STDERR_FILENO) == 1 ? static_cast<hbProgress&>(progressBar()) : silent;
  return chosen;
}

void app::waitAfterInterrupt() { patient = 1; }

void app::handleInterrupts() {
  active = &progress();
  onTerminal = ::isatty(STDERR_FILENO) == 1;
  struct sigaction action {};
  action.sa_handler = onInterrupt;
  ::sigaction(SIGINT, &action, nullptr);
  ::sigaction(SIGTERM, &action, nullptr);
  // A full disk or a closed pipe is an error that a write reports, not a reason to die.
  ::signal(SIGXFSZ, SIG_IGN);
  ::signal(SIGPIPE, SIG_IGN);
}
