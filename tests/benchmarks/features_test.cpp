#include "benchmarks/features.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>

namespace mpm::bench {
namespace {

const Feature& feature_named(const std::vector<Feature>& all, const std::string& name) {
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const Feature& feature) { return feature.name == name; });
  if (found == all.end()) throw std::runtime_error("no feature " + name);
  return *found;
}

/// In one round, as short as can be: times mean nothing.
std::vector<FeatureResult> measured(const std::vector<Feature>& features, std::vector<std::string>& errors) {
  return measure_features(
      features, {1, 1, 1e-5}, [](const std::string&) {}, errors);
}

TEST(Features, have_names_of_their_own_and_scenes_that_differ) {
  std::vector<std::string> names;
  for (const Feature& feature : features()) {
    EXPECT_TRUE(feature.name.starts_with("feature/")) << feature.name;
    EXPECT_EQ(std::count(names.begin(), names.end(), feature.name), 0) << feature.name;
    names.push_back(feature.name);
    EXPECT_TRUE(feature.without.text != feature.with.text || feature.without.threads != feature.with.threads ||
                feature.without.watched != feature.with.watched)
        << feature.name;
    if (feature.spelled) {
      const FeatureScene& unsaid = feature.spelled->is_of_with ? feature.with : feature.without;
      EXPECT_NE(feature.spelled->scene.text, unsaid.text) << feature.name;
    }
  }
  EXPECT_GE(names.size(), 18u);
}

/// The scenes run, and what is said is what is left out, to the bit and byte.
TEST(Features, that_are_switched_off_are_free) {
  std::vector<std::string> errors;
  const std::vector<Feature> all = features();
  const std::vector<FeatureResult> results = measured(all, errors);
  EXPECT_EQ(errors, std::vector<std::string>{});
  ASSERT_EQ(results.size(), all.size());
  for (const FeatureResult& result : results) {
    EXPECT_GT(result.ratio.value, 0) << result.name;
    EXPECT_GT(result.without.step.value, 0) << result.name;
    if (!result.spelled) continue;
    EXPECT_TRUE(result.spelled->same_bits) << result.name;
    EXPECT_EQ(result.spelled->bytes, (result.spelled->of_with ? result.with : result.without).bytes)
        << result.name;
  }
}

TEST(Features, that_need_memory_are_seen_to_need_it) {
  const std::vector<Feature> all = features();
  std::vector<std::string> errors;
  const auto bytes_more = [&](const char* name) {
    const FeatureResult result = measured({feature_named(all, name)}, errors).at(0);
    return static_cast<double>(result.with.bytes - result.without.bytes) /
           static_cast<double>(result.with.particles);
  };
  // Two numbers more in every slot, of which no more than one in six is empty.
  EXPECT_GE(bytes_more("feature/second_mapping"), 16.0);
  EXPECT_LE(bytes_more("feature/second_mapping"), 19.2);
  EXPECT_EQ(bytes_more("feature/damping"), 0.0);
}

TEST(Features, a_scene_that_cannot_be_measured_is_told_and_left_out) {
  std::vector<Feature> two = {feature_named(features(), "feature/damping"),
                              feature_named(features(), "feature/second_dimension")};
  two[0].with.text["damping"] = 2;
  two[1].without.text["termination"]["time"] = "1 us";
  std::vector<std::string> errors;
  EXPECT_TRUE(measured(two, errors).empty());
  ASSERT_EQ(errors.size(), 2u);
  EXPECT_TRUE(errors[0].starts_with("feature/damping: /scene/damping: expected")) << errors[0];
  EXPECT_NE(errors[1].find("the scene ended: reached_time"), std::string::npos) << errors[1];
}

TEST(Features, a_default_that_is_not_what_is_left_out_is_seen) {
  Feature damping = feature_named(features(), "feature/damping");
  damping.spelled->scene.text["damping"] = 0.5;
  std::vector<std::string> errors;
  EXPECT_FALSE(measured({damping}, errors).at(0).spelled->same_bits);
}

}  // namespace
}  // namespace mpm::bench
