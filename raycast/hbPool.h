#pragma once

#include <memory>
#include <mutex>
#include <utility>
#include <vector>

/// Things that are dear to make and used by one thread at a time: they come back for the next one to use.
template <class T>
class hbPool {
public:
  /// One of them, until the lease ends.
  class Lease {
  public:
    explicit Lease(hbPool& pool) : pool_(pool), thing_(pool.take()) {}
    ~Lease() { pool_.putBack(std::move(thing_)); }
    Lease(const Lease&) = delete;
    Lease& operator=(const Lease&) = delete;
    T& operator*() const { return *thing_; }
    T* operator->() const { return thing_.get(); }

  private:
    hbPool& pool_;
    std::unique_ptr<T> thing_;
  };

private:
  std::unique_ptr<T> take() {
    const std::lock_guard lock(mutex_);
    if (things_.empty()) return std::make_unique<T>();
    std::unique_ptr<T> last = std::move(things_.back());
    things_.pop_back();
    return last;
  }
  void putBack(std::unique_ptr<T> thing) {
    const std::lock_guard lock(mutex_);
    things_.push_back(std::move(thing));
  }

  std::mutex mutex_;
  std::vector<std::unique_ptr<T>> things_;
};
