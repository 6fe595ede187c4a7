#include "vv/quantity.hpp"

#include <gtest/gtest.h>

#include <clocale>
#include <cmath>
#include <string>
#include <vector>

namespace mpm::vv {
namespace {

struct Reading {
  std::string text;
  QuantityKind kind;
  double value;
};

// Compared exactly: a quantity is the double nearest to the number written, as the compiler reads it too.
TEST(Quantity, is_read_into_the_nearest_double_in_si_units) {
  const std::vector<Reading> readings = {
      {"0.02 m", QuantityKind::length, 0.02},
      {"20 mm", QuantityKind::length, 0.02},
      {"2 cm", QuantityKind::length, 0.02},
      {"0.2 cm", QuantityKind::length, 0.002},
      {"1.04 m", QuantityKind::length, 1.04},
      {"-3 km", QuantityKind::length, -3000.0},
      {"0 m", QuantityKind::length, 0.0},
      {"15 us", QuantityKind::time, 1.5e-5},
      {"0.015 ms", QuantityKind::time, 1.5e-5},
      {"4e-5 s", QuantityKind::time, 4e-5},
      {"10000 kPa", QuantityKind::pressure, 1e7},
      {"1E1 MPa", QuantityKind::pressure, 1e7},
      {"0.1 GPa", QuantityKind::pressure, 1e8},
      {"1e+3 Pa", QuantityKind::pressure, 1e3},
      {"1000 kg/m^3", QuantityKind::density, 1000.0},
      {"2.43 g/cm^3", QuantityKind::density, 2430.0},
      {"2.43 t/m^3", QuantityKind::density, 2430.0},
      {"-9.8 m/s^2", QuantityKind::acceleration, -9.8},
      {"0.3 cm/s", QuantityKind::velocity, 0.003},
      {"-0.5 rad/s", QuantityKind::angular_velocity, -0.5},
  };
  for (const Reading& reading : readings) {
    EXPECT_EQ(parse_quantity(reading.text, reading.kind), reading.value) << reading.text;
  }
}

TEST(Quantity, is_read_in_every_unit_of_its_kind) {
  for (const QuantityKind kind :
       {QuantityKind::length, QuantityKind::time, QuantityKind::pressure, QuantityKind::density,
        QuantityKind::acceleration, QuantityKind::velocity, QuantityKind::angular_velocity}) {
    ASSERT_FALSE(units_of(kind).empty());
    EXPECT_EQ(units_of(kind).front().exponent, 0) << "the SI unit comes first";
    for (const Unit& unit : units_of(kind)) {
      const std::string text = "1 " + std::string(unit.symbol);
      EXPECT_EQ(parse_quantity(text, kind), std::stod("1e" + std::to_string(unit.exponent))) << text;
      EXPECT_NE(expectation_of(kind).find(unit.symbol), std::string::npos);
    }
  }
}

TEST(Quantity, has_an_example_that_is_one) {
  for (const QuantityKind kind :
       {QuantityKind::length, QuantityKind::time, QuantityKind::pressure, QuantityKind::density,
        QuantityKind::acceleration, QuantityKind::velocity, QuantityKind::angular_velocity}) {
    const std::string expectation = expectation_of(kind);
    const std::size_t first = expectation.find('"') + 1;
    const std::string example = expectation.substr(first, expectation.rfind('"') - first);
    EXPECT_NO_THROW(parse_quantity(example, kind)) << example;
  }
}

struct Refused {
  std::string text;
  QuantityKind kind;
  std::string found;
};

TEST(Quantity, is_refused_with_what_was_expected_and_found) {
  const std::vector<Refused> refusals = {
      {"10000 kN", QuantityKind::pressure, "\"10000 kN\""},
      {"10000 m", QuantityKind::pressure, "\"10000 m\", a length"},
      {"9.8 kN/m^3", QuantityKind::density,
       "\"9.8 kN/m^3\", a unit weight: divide it by the acceleration of gravity"},
      {"0.02", QuantityKind::length, "\"0.02\", which has no unit"},
      {"0.02m", QuantityKind::length, "\"0.02m\", without a blank between number and unit"},
      {"0.02  m", QuantityKind::length, "\"0.02  m\""},
      {"0.02 m ", QuantityKind::length, "\"0.02 m \""},
      {" 0.02 m", QuantityKind::length, "\" 0.02 m\""},
      {"0.02 m deep", QuantityKind::length, "\"0.02 m deep\""},
      {"0.02 M", QuantityKind::length, "\"0.02 M\""},
      {"0,02 m", QuantityKind::length, "\"0,02 m\", without a blank between number and unit"},
      {"+1 m", QuantityKind::length, "\"+1 m\""},
      {".5 m", QuantityKind::length, "\".5 m\""},
      {"5. m", QuantityKind::length, "\"5. m\""},
      {"1e m", QuantityKind::length, "\"1e m\""},
      {"0x10 m", QuantityKind::length, "\"0x10 m\", without a blank between number and unit"},
      {"inf m", QuantityKind::length, "\"inf m\""},
      {"nan m", QuantityKind::length, "\"nan m\""},
      {"-inf s", QuantityKind::time, "\"-inf s\""},
      {"1e400 m", QuantityKind::length, "\"1e400 m\", beyond the range of a floating-point number"},
      {"1e306 GPa", QuantityKind::pressure, "\"1e306 GPa\", beyond the range of a floating-point number"},
      {"1e99999999999 m", QuantityKind::length,
       "\"1e99999999999 m\", beyond the range of a floating-point number"},
      {"30 deg", QuantityKind::angular_velocity, "\"30 deg\", an angle"},
      {"", QuantityKind::length, "\"\""},
      {"m", QuantityKind::length, "\"m\""},
      {"1 m\n2", QuantityKind::length, "\"1 m?2\""},
      {"1 \xc2\xb5m", QuantityKind::length, "\"1 ??m\""},
      {std::string("1 m\0", 4), QuantityKind::length, "\"1 m?\""},
  };
  for (const Refused& refused : refusals) {
    try {
      const double value = parse_quantity(refused.text, refused.kind);
      ADD_FAILURE() << refused.text << " was read as " << value;
    } catch (const QuantityError& error) {
      EXPECT_EQ(error.expected(), expectation_of(refused.kind));
      EXPECT_EQ(error.found(), refused.found);
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    }
  }
}

TEST(Quantity, says_what_a_pressure_looks_like) {
  EXPECT_EQ(expectation_of(QuantityKind::pressure),
            "a pressure such as \"10 kPa\" (units Pa, kPa, MPa, GPa)");
  EXPECT_EQ(expectation_of(QuantityKind::acceleration),
            "an acceleration such as \"-9.8 m/s^2\" (unit m/s^2)");
}

TEST(Quantity, of_great_length_is_cut_in_the_message) {
  try {
    parse_quantity(std::string(1000, '1') + " q", QuantityKind::length);
    FAIL();
  } catch (const QuantityError& error) {
    EXPECT_EQ(error.found(), "\"" + std::string(60, '1') + "...\"");
  }
}

// Where the system lacks the locale, setlocale leaves everything as it was and the test still holds.
TEST(Quantity, does_not_depend_on_the_locale) {
  const std::string before = std::setlocale(LC_ALL, nullptr);
  std::setlocale(LC_ALL, "de_DE.UTF-8");
  EXPECT_EQ(parse_quantity("1.5 m", QuantityKind::length), 1.5);
  std::setlocale(LC_ALL, before.c_str());
}

}  // namespace
}  // namespace mpm::vv
