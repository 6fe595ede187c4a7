#include "vv/record.hpp"
#include "vv/revision.hpp"

namespace mpm::vv {

Record simulate(const Case& definition, const RunRequest& request, const Pulse& pulse) {
  Record record = unsigned_record(definition, request, pulse);
  record.program_hash = program_hash();
  record.revision = build_facts().revision;
  return record;
}

std::string program_hash() { return build_facts().simulation; }

}  // namespace mpm::vv
