#pragma once

#include "reports/page_data.hpp"
#include "vv/verdict.hpp"

namespace mpm::reports {

/// The part of a case's section that tells how advice drawn from another case turned out: `advice`, with
/// `of`, `own`, `lack` and a list `trials`. Nothing of a case that puts none to the test.
void set_advice(PageData& section, const vv::CaseVerdict& verdict);

}  // namespace mpm::reports
