// The rules of the house that a machine can check: who may include whom, and what may not appear where.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

/// One thing that may not be: where it is looked for, and what it looks like on a line.
struct Rule {
  std::string name;
  std::function<bool(const fs::path&)> applies;  ///< path from the root of the tree
  std::regex forbidden;
};

std::string folder_of(const fs::path& path) { return path.has_parent_path() ? path.begin()->string() : ""; }

bool is_header(const fs::path& path) { return path.extension() == ".hpp"; }

bool is_code(const fs::path& path) { return is_header(path) || path.extension() == ".cpp"; }

bool is_physics(const fs::path& path) {
  return is_code(path) && (folder_of(path) == "solver" || folder_of(path) == "reference");
}

const std::vector<Rule>& rules() {
  static const std::vector<Rule> all = {
      {"only reports/canvas.cpp includes OpenGL",
       [](const fs::path& path) { return is_code(path) && path != "reports/canvas.cpp"; },
       std::regex(R"(^\s*#\s*include\s*["<](GL/|GLES|EGL/|.*osmesa))", std::regex::icase)},
      {"no OpenGL type in a header", is_header, std::regex(R"(\b(GL[a-z]+|OSMesa\w+)\b)")},
      {"no JSON and no files below vv", is_physics,
       std::regex(R"(^\s*#\s*include\s*["<](nlohmann|valijson|fstream|filesystem|CLI))")},
      {"no path of a particular machine", [](const fs::path&) { return true; },
       std::regex(R"((^|[^\w.)}\]*/$-])/(work|home|root|tmp)\b)")},
      {"no manager, helper or utils", is_code,
       std::regex(R"(\b\w*(manager|helper|utils)\w*\b)", std::regex::icase)},
      {"no -ffast-math", [](const fs::path& path) { return path.filename() == "CMakeLists.txt"; },
       std::regex(R"(-ffast-math|-Ofast)")},
  };
  return all;
}

/// Folders, or single headers, that the files of a folder may include; a folder that is not listed may include any.
const std::map<std::string, std::vector<std::string>>& permitted_includes() {
  static const std::map<std::string, std::vector<std::string>> table = {
      {"solver", {"solver"}},
      {"reference", {"reference"}},
      {"vv", {"solver", "reference", "vv"}},
      {"reports", {"vv", "reports"}},
      {"benchmarks", {"solver", "vv/case_file.hpp", "vv/json_reader.hpp", "vv/revision.hpp", "vv/scene_reader.hpp", "vv/step_cost.hpp", "benchmarks"}},
  };
  return table;
}

/// Whether `file` may include `"included"`; a name without a folder is a neighbour.
bool may_include(const fs::path& file, const std::string& included) {
  const auto row = permitted_includes().find(folder_of(file));
  if (row == permitted_includes().end() || included.find('/') == std::string::npos) return true;
  for (const std::string& permitted : row->second)
    if (included == permitted || included.starts_with(permitted + "/")) return true;
  return false;
}

/// The line without comment and without what strings say: words for people may be any.
std::string code_of(const std::string& line) {
  static const std::regex comment_or_string(R"re("(\\.|[^"\\])*"|//.*)re");
  static const std::regex include(R"(^\s*#\s*include.*)");
  return std::regex_match(line, include) ? line : std::regex_replace(line, comment_or_string, "");
}

/// Everything in a file that breaks a rule, one line each: "file:line: rule: text".
std::vector<std::string> violations(const fs::path& file, const std::string& text) {
  static const std::regex own_include(R"re(^\s*#\s*include\s*"([^"]+)")re");
  static const std::regex unfit_name("manager|helper|utils", std::regex::icase);
  std::vector<std::string> found;
  int number = 0;
  const auto report = [&](const std::string& rule, const std::string& line) {
    found.push_back(file.string() + ":" + std::to_string(number) + ": " + rule + ": " + line);
  };

  if (std::regex_search(file.filename().string(), unfit_name)) report("unfit file name", file.filename().string());
  if (is_header(file) && text.find("#pragma once\n") == std::string::npos) report("no #pragma once", "");

  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    ++number;
    std::smatch match;
    if (is_code(file) && std::regex_search(line, match, own_include) && !may_include(file, match[1]))
      report(folder_of(file) + " may not include this", line);
    // A path hides in a string as well as anywhere; every other rule is about code.
    for (const Rule& rule : rules())
      if (rule.applies(file) && std::regex_search(rule.name.starts_with("no path") ? line : code_of(line), rule.forbidden))
        report(rule.name, line);
  }
  return found;
}

/// The sources of the tree: everything of a known kind outside what builds and runs leave behind.
std::vector<fs::path> sources(const fs::path& root) {
  std::vector<fs::path> found;
  for (const std::string top : {"", "solver", "reference", "vv", "reports", "benchmarks", "tests", ".ci"}) {
    if (!fs::exists(root / top)) continue;
    for (auto entry = fs::recursive_directory_iterator(root / top); entry != fs::end(entry); ++entry) {
      if (entry->is_directory() && (top.empty() || entry->path().filename() == "out")) entry.disable_recursion_pending();
      if (!entry->is_regular_file()) continue;
      const std::string kind = entry->path().extension().string();
      for (const char* known : {".cpp", ".hpp", ".json", ".txt", ".md", ".sh", ".html", ".css", ".js", ""})
        if (kind == known) found.push_back(entry->path().lexically_relative(root));
    }
  }
  return found;
}

std::string read(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

TEST(HouseRules, hold_in_every_source) {
  const fs::path root = MPMVV_ROOT;
  const std::vector<fs::path> files = sources(root);
  for (const char* expected : {"mpmvv", "CMakeLists.txt", "solver/scene.hpp", "vv/record.hpp", "tests/house_rules_test.cpp"})
    EXPECT_NE(std::find(files.begin(), files.end(), expected), files.end()) << expected << " was not looked at";
  for (const fs::path& file : files)
    for (const std::string& violation : violations(file, read(root / file))) ADD_FAILURE() << violation;
}

/// A line that breaks a rule in one file, and the same or a similar one that is fine.
struct Example {
  fs::path file;
  std::string line;
};

TEST(HouseRules, refuse_what_breaks_them) {
  const std::vector<Example> bad = {
      {"solver/a.cpp", "#include \"vv/record.hpp\""},
      {"solver/a.cpp", "#include \"reference/column.hpp\""},
      {"solver/a.cpp", "  #  include \"../vv/record.hpp\""},
      {"reference/a.cpp", "#include \"solver/scene.hpp\""},
      {"vv/a.hpp", "#include \"reports/plot.hpp\""},
      {"reports/a.cpp", "#include \"solver/scene.hpp\""},
      {"reports/a.cpp", "#include \"reference/column.hpp\""},
      {"benchmarks/a.cpp", "#include \"vv/record.hpp\""},
      {"solver/a.cpp", "#include <nlohmann/json.hpp>"},
      {"reference/a.cpp", "#include <fstream>"},
      {"reports/plot.cpp", "#include <GL/osmesa.h>"},
      {"reports/canvas.hpp", "  GLuint texture_;"},
      {"reports/canvas.hpp", "  OSMesaContext context_;"},
      {"vv/a.cpp", "const char* place = \"/" "tmp/out\";"},
      {"CMakeLists.txt", "set(PLACE /" "home/me)"},
      {"README.md", "Results are in `/" "work/main`."},
      {"vv/case_manager.hpp", ""},
      {"tests/support/helpers.cpp", ""},
      {"vv/a.cpp", "class RunManager;"},
      {"solver/CMakeLists.txt", "target_compile_options(a PRIVATE -ffast-math)"},
  };
  for (const Example& example : bad)
    EXPECT_EQ(violations(example.file, "#pragma once\n" + example.line).size(), 1u) << example.file << ": " << example.line;
  EXPECT_EQ(violations("vv/a.hpp", "int a;\n").size(), 1u) << "a header without #pragma once";
}

TEST(HouseRules, accept_what_keeps_them) {
  const std::vector<Example> good = {
      {"solver/a.cpp", "#include \"solver/scene.hpp\""},
      {"solver/a.cpp", "#include \"scene.hpp\""},
      {"vv/a.cpp", "#include \"reference/column.hpp\""},
      {"vv/a.cpp", "#include <nlohmann/json.hpp>"},
      {"reports/a.cpp", "#include \"vv/verdict.hpp\""},
      {"reports/canvas.cpp", "#include <GL/osmesa.h>"},
      {"benchmarks/a.cpp", "#include \"vv/case_file.hpp\""},
      {"tests/vv/a_test.cpp", "#include \"solver/scene.hpp\""},
      {"vv/a.cpp", "// a helper would hide this"},
      {"vv/a.cpp", "const char* pointer = \"/scene/bodies\"; const auto file = root + \"/vv/tmp\";"},
      {"README.md", "external/work and build/tmp, https://example.org/home"},
  };
  for (const Example& example : good)
    EXPECT_EQ(violations(example.file, "#pragma once\n" + example.line), std::vector<std::string>{}) << example.line;
}

}  // namespace
