#include "benchmarks/command_line.hpp"

int main(int argc, char** argv) { return mpm::bench::command_line(argc, argv); }
