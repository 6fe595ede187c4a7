#pragma once

#include <atomic>
#include <cstdint>
#include <thread>
#include <type_traits>
#include <vector>

namespace mpm {

/// Threads that share the tasks of one step. Which thread does which task changes no result: tasks write to
/// places of their own. A thread that is awake takes the next task, so that one the system has put to sleep
/// holds up nothing but the task it is in.
class Workers {
 public:
  /// `threads` >= 1, the caller's own included.
  explicit Workers(int threads);
  ~Workers();
  Workers(const Workers&) = delete;
  Workers& operator=(const Workers&) = delete;

  /// Calls `task(k)` for k in [0, count), count < 65536, and returns when all are done. Tasks must not throw.
  template <class Task>
  void run(int count, Task&& task) {
    if (threads_.empty() || count < 2) {
      for (int k = 0; k < count; ++k) task(k);
      return;
    }
    share(
        static_cast<std::uint32_t>(count),
        [](void* context, int k) { (*static_cast<std::remove_reference_t<Task>*>(context))(k); }, &task);
  }

  int threads() const { return static_cast<int>(threads_.size()) + 1; }

 private:
  using Call = void (*)(void* context, int k);

  void share(std::uint32_t count, Call call, void* context);
  void work();
  void take_tasks();

  // What the tasks of a round are. A late thread may read them while those of the next round are written; it
  // then gets no task, because the round whose number it has is used up.
  std::atomic<Call> call_{nullptr};
  std::atomic<void*> context_{nullptr};
  std::atomic<bool> stopping_{false};
  alignas(64) std::atomic<std::uint64_t> next_{0};  ///< 32 bits of round, 16 of task count, 16 of next task
  alignas(64) std::atomic<std::uint32_t> finished_{0};
  std::vector<std::jthread> threads_;  // last, so that they end before what they look at
};

}  // namespace mpm
