#include "reports/document.hpp"
#include "reports/performance.hpp"
#include "vv/command_line.hpp"

namespace {

using namespace mpm;

/// All measurements that the command line names.
reports::PerformanceEvidence evidence_of(const vv::PerformanceFiles& files) {
  reports::PerformanceEvidence evidence;
  evidence.failure = files.failure;
  if (!files.file.empty()) evidence.measured = reports::read_performance(files.file);
  if (!files.history.empty()) evidence.history = reports::read_performance_history(files.history);
  evidence.drop_present_from_history();
  return evidence;
}

}  // namespace

int main(int argc, char** argv) {
  reports::PerformanceEvidence evidence;
  const auto read = [&evidence](const vv::PerformanceFiles& files) -> std::optional<vv::MeasuredBy> {
    evidence = evidence_of(files);
    if (!evidence.measured) return std::nullopt;
    return vv::MeasuredBy{evidence.measured->full_revision(), evidence.measured->processor,
                          evidence.measured->cores};
  };
  const auto write = [&evidence](const vv::CampaignVerdict& verdict, const std::filesystem::path& directory) {
    reports::write_report(verdict, directory, evidence);
  };
  return vv::command_line(argc, argv, {.read_performance = read, .write = write});
}
