#pragma once

#include "solver/lanes.hpp"

namespace mpm {

/// Adds to a running sum that lives in two numbers, and keeps in `low` what rounding has cut off `sum` so far: the
/// next increment takes it along [Kahan65]. What one addition loses is found exactly, whichever of the two is larger
/// [Knuth69]; it takes six additions, none of which a compiler may leave out without -ffast-math.
template <class Value>
void add_compensated(const Value& increment, Scalar<Value>* sum, Scalar<Value>* low) {
  const Value old = load<Value>(sum), wanted = increment + load<Value>(low);
  const Value found = old + wanted, added = found - old;
  store(found, sum);
  store((old - (found - added)) + (wanted - added), low);
}

}  // namespace mpm
