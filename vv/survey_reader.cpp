#include "vv/survey_reader.hpp"

#include <string>

namespace mpm::vv {
namespace {

/// Each run is a simulation; beyond these a slip is likelier than a wish.
constexpr int fewest_points = 2, most_points = 64, most_bisections = 20;

double positive_or(const JsonPlace& place, double otherwise) {
  if (!place.present()) return otherwise;
  const double number = place.number();
  if (!(number > 0.0)) place.refuse("a number above zero");
  return number;
}

int integer_or(const JsonPlace& place, int least, int most, int otherwise) {
  if (!place.present()) return otherwise;
  const auto number = place.integer();
  if (number < least || number > most)
    place.refuse("a whole number from " + std::to_string(least) + " to " + std::to_string(most));
  return static_cast<int>(number);
}

}  // namespace

std::optional<SurveyRequest> read_survey(const JsonPlace& place) {
  if (!place.present()) return std::nullopt;
  place.allow_only({"from", "to", "points", "bisections", "runs", "accuracy", "times_least"});
  SurveyRequest request;
  request.from = positive_or(place["from"], request.from);
  request.to = positive_or(place["to"], request.to);
  if (!(request.to > request.from)) place["to"].refuse("a number above \"from\"");
  request.points = integer_or(place["points"], fewest_points, most_points, request.points);
  request.bisections = integer_or(place["bisections"], 0, most_bisections, request.bisections);
  request.runs = place["runs"].flag_or(request.runs);
  request.accuracy = positive_or(place["accuracy"], request.accuracy);
  request.times_least = positive_or(place["times_least"], request.times_least);
  return request;
}

void refuse_beside_survey(const JsonPlace& place) {
  for (const char* key : {"metamorphoses", "probes", "snapshots", "cuts", "measurements", "pairs", "readings",
                          "trades", "advice", "rounding"}) {
    if (place[key].present()) place[key].refuse("no such key beside \"stability\", whose runs are surveys");
  }
}

}  // namespace mpm::vv
