#include "solver/workers.hpp"

namespace mpm {
namespace {

constexpr std::uint32_t round_of(std::uint64_t next) { return static_cast<std::uint32_t>(next >> 32); }
constexpr std::uint32_t count_of(std::uint64_t next) { return static_cast<std::uint16_t>(next >> 16); }
constexpr std::uint32_t task_of(std::uint64_t next) { return static_cast<std::uint16_t>(next); }
constexpr std::uint64_t first_of_next_round(std::uint64_t next, std::uint32_t count) {
  return (static_cast<std::uint64_t>(round_of(next) + 1) << 32) | (std::uint64_t{count} << 16);
}

/// Waits until a condition holds: awake at first, because the next task comes within microseconds while a run
/// goes on; then giving way to whoever waits for the processor; asleep only after some milliseconds. Waking a
/// virtual processor takes so long that the others fall asleep meanwhile, and a step that has once slept
/// would go on from sleep to sleep at half its speed.
template <class Value, class Condition>
void wait(const std::atomic<Value>& value, Condition&& holds) {
  constexpr int looks_awake = 4000, looks_giving_way = 10000;
  for (int look = 0; look < looks_awake + looks_giving_way; ++look) {
    if (holds(value.load(std::memory_order_acquire))) return;
    if (look >= looks_awake) {
      std::this_thread::yield();
    } else {
#if defined(__x86_64__)
      __builtin_ia32_pause();
#endif
    }
  }
  for (Value seen = value.load(std::memory_order_acquire); !holds(seen);
       seen = value.load(std::memory_order_acquire)) {
    value.wait(seen, std::memory_order_acquire);
  }
}

}  // namespace

Workers::Workers(int threads) {
  for (int worker = 1; worker < threads; ++worker) threads_.emplace_back([this] { work(); });
}

Workers::~Workers() {
  stopping_ = true;
  next_ = first_of_next_round(next_, 0);
  next_.notify_all();
}

void Workers::share(std::uint32_t count, Call call, void* context) {
  call_.store(call, std::memory_order_relaxed);
  context_.store(context, std::memory_order_relaxed);
  finished_.store(0, std::memory_order_relaxed);
  next_.store(first_of_next_round(next_.load(std::memory_order_relaxed), count), std::memory_order_release);
  next_.notify_all();
  take_tasks();
  wait(finished_, [&](std::uint32_t finished) { return finished == count; });
}

void Workers::take_tasks() {
  std::uint64_t next = next_.load(std::memory_order_acquire);
  for (;;) {
    const Call call = call_.load(std::memory_order_relaxed);
    void* const context = context_.load(std::memory_order_relaxed);
    if (task_of(next) == count_of(next)) return;
    if (!next_.compare_exchange_weak(next, next + 1, std::memory_order_acq_rel, std::memory_order_acquire)) {
      continue;
    }
    call(context, static_cast<int>(task_of(next)));
    const std::uint32_t count = count_of(next);
    if (finished_.fetch_add(1, std::memory_order_acq_rel) + 1 == count) finished_.notify_one();
    next = next_.load(std::memory_order_acquire);
  }
}

void Workers::work() {
  for (std::uint64_t seen = 0; !stopping_;) {
    wait(next_, [&](std::uint64_t next) { return round_of(next) != round_of(seen); });
    seen = next_.load(std::memory_order_acquire);
    take_tasks();
  }
}

}  // namespace mpm
