// SPDX-License-Identifier: Apache-2.0
// What it took and what was asked: times, files, options.
#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "report/sections.hpp"

namespace delfront {

namespace {

struct Stage {
  std::string name;
  double seconds = 0;
};

/// Stages that ran more than once, added up.
std::vector<Stage> summed_stages(const Json& r) {
  std::vector<Stage> stages;
  for (const Json& stage : part_of(r, "stages")) {
    const std::string name = text_of(stage, "stage");
    const double seconds = part_of(stage, "seconds").is_number() ? stage["seconds"].get<double>() : 0;
    const auto it = std::find_if(stages.begin(), stages.end(), [&](const Stage& s) { return s.name == name; });
    if (it == stages.end())
      stages.push_back({name, seconds});
    else
      it->seconds += seconds;
  }
  return stages;
}

/// Each option with its whole key, in the order of a job file.
void flatten(const Json& tree, const std::string& path, std::vector<std::pair<std::string, const Json*>>& result) {
  for (const auto& [name, value] : tree.items()) {
    const std::string key = path.empty() ? name : path + "." + name;
    if (value.is_object())
      flatten(value, key, result);
    else
      result.push_back({key, &value});
  }
}

std::string option_line(const std::string& key, const Json& value) {
  return "<p class=\"mono\">" + html(key) + " = " + html(value.dump(-1, ' ', false, Json::error_handler_t::replace)) +
         "</p>";
}

std::string options_lists(const Json& options, const Json& defaults) {
  std::vector<std::pair<std::string, const Json*>> all, usual;
  flatten(options, "", all);
  flatten(defaults, "", usual);
  std::string asked, rest;
  for (const auto& [key, value] : all) {
    const auto is_key = [&key = key](const auto& entry) { return entry.first == key; };
    const auto it = std::find_if(usual.begin(), usual.end(), is_key);
    const bool is_usual = it != usual.end() && *it->second == *value;
    (is_usual ? rest : asked) += option_line(key, *value);
  }
  std::string text;
  if (!asked.empty()) text += "<div class=\"columns\">" + asked + "</div>";
  if (!rest.empty())
    text += "<details><summary>All others, as they are unless they are set</summary><div class=\"columns\">" + rest +
            "</div></details>";
  return text;
}

std::string file_rows(const char* what, const Json& files) {
  std::string rows;
  for (const Json& file : files)
    rows += fmt::format("<tr><td>{}</td><td class=\"mono\">{}</td><td></td><td></td></tr>", what,
                        html(file.get<std::string>()));
  return rows;
}

std::string files_table(const Json& r) {
  std::string rows;
  for (const Json& input : part_of(r, "inputs"))
    rows += fmt::format(
        "<tr><td>read</td><td class=\"mono\">{}</td><td class=\"num\">{} bytes</td><td class=\"mono "
        "note\">{}</td></tr>",
        html(text_of(input, "path")), count_text(part_of(input, "bytes")), html(text_of(input, "hash")));
  for (const char* key : {"input", "geometry"})
    if (const std::string file = text_of(r, key); !file.empty())
      rows += fmt::format("<tr><td>read</td><td class=\"mono\">{}</td><td></td><td></td></tr>", html(file));
  rows += file_rows("written", part_of(r, "files_written"));
  const Json& starter = part_of(r, "starter_files");
  rows += file_rows("written", part_of(starter, "written"));
  rows += file_rows("kept", part_of(starter, "kept"));
  return rows.empty() ? "" : "<div class=\"wide\"><table>" + rows + "</table></div>";
}

}  // namespace

std::string times_section(const Json& r) {
  const std::vector<Stage> stages = summed_stages(r);
  double longest = 0;
  for (const Stage& stage : stages) longest = std::max(longest, stage.seconds);
  std::string rows;
  for (const Stage& stage : stages)
    rows += fmt::format(
        "<tr><td class=\"name\">{}</td><td class=\"num\">{}</td><td class=\"meter\"><div "
        "style=\"width:{:.1f}%\"></div></td></tr>",
        html(stage.name), seconds_text(stage.seconds), longest > 0 ? 100 * stage.seconds / longest : 0);
  if (rows.empty()) return "";
  const Json& bytes = part_of(r, "bytes_per_cell");
  return "<section><h2>Stages</h2><table>" + rows + "</table><p class=\"note\">In all " +
         seconds_text(part_of(r, "seconds").is_number() ? r["seconds"].get<double>() : 0) +
         (bytes.is_number() ? "; at the peak " + count_text(bytes) + " bytes of memory a cell" : "") +
         ".</p></section>";
}

std::string options_section(const Json& r, const Json& defaults) {
  std::string text;
  if (const std::string files = files_table(r); !files.empty()) text += "<h2>Files</h2>" + files;
  if (const Json& options = part_of(r, "options"); options.is_object())
    text += "<h2>Options</h2>" + options_lists(options, defaults);
  return text.empty() ? "" : "<section class=\"long\">" + text + "</section>";
}

}  // namespace delfront
