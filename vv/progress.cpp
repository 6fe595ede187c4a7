#include "vv/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace mpm::vv {

Progress::Progress() : on_terminal_(::isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
  if (on_terminal_) std::fputs("\r\033[K", stderr);
}

double Progress::elapsed() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

void Progress::draw(double fraction, const std::string& state) {
  const double since = elapsed();
  if (!on_terminal_ && since < next_line_) return;
  const std::string left =
      fraction > 0.02 ? fmt::format("  {:.0f} s left", since * (1.0 - fraction) / fraction) : "";
  if (on_terminal_) {
    constexpr int width = 30;
    const int filled = static_cast<int>(std::clamp(fraction, 0.0, 1.0) * width);
    fmt::print(stderr, "\r\033[K[{:#<{}}{:.<{}}] {}{}", "", filled, "", width - filled, state, left);
  } else {
    fmt::print(stderr, "{:3.0f} %  {}{}\n", 100 * fraction, state, left);
    next_line_ = since + seconds_between_lines;
  }
  std::fflush(stderr);
}

}  // namespace mpm::vv
