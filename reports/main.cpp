#include "reports/document.hpp"
#include "vv/command_line.hpp"

int main(int argc, char** argv) { return mpm::vv::command_line(argc, argv, mpm::reports::write_report); }
